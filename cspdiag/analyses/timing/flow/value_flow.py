"""How values go from place to place within the samples of loops, and from one loop to another."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from cspdiag.analyses.timing.flow.behaviours import Behaviour
from cspdiag.analyses.timing.flow.demands import begun_by
from cspdiag.analyses.timing.flow.paths import Job
from cspdiag.analyses.timing.threads.graph import Move
from cspdiag.analyses.timing.threads.offers import capacities
from cspdiag.base.record import record
from cspdiag.network.ir.network import ChannelKind, CoreNetwork

Spot = tuple[int, int]
"""A place of a thread, by their numbers."""


@dataclass
class Stage:
    """A sampled loop as something that values pass: at ``spots`` it hands them on, and ``taken`` are those of them
    where another loop begins what is done, between the samples of its own. ``mode`` is the thread and its cycle.
    """

    period: int
    response: int
    mode: tuple[int, int]
    spots: set[Spot] = field(default_factory=set)
    taken: set[Spot] = field(default_factory=set)
    jobs: dict[int, list[Job]] = field(default_factory=lambda: defaultdict(list))
    """By thread, the jobs that these are part of."""


@record
class Hop:
    """From a spot to another one: in the same sample, or to a sample of the stage ``to``. ``waits`` is the time from
    the sample until that one has the value, at most; in the same sample only what it may lie in a channel.
    """

    to: int
    spot: Spot
    in_sample: bool
    waits: int = 0


class Passing:
    """What the stages hand on to each other."""

    def __init__(self, network: CoreNetwork, behaviours: Mapping[int, Behaviour], stages: Sequence[Stage]) -> None:
        self._behaviours = behaviours
        self._stages = stages
        self._kinds = {net.path: net.kind for net in network.nets if net.external is None}
        self._capacities = capacities(network)
        self.periods = {
            net.path: None if net.sampling is None else net.sampling.period
            for net in network.nets
            if net.external is not None
        }
        self._taking_part: dict[tuple[str, bool], list[Behaviour]] = defaultdict(list)
        for one in behaviours.values():
            for channel, writes in {(job.offer.channel, job.offer.writes) for job in one.jobs if job.offer is not None}:
                self._taking_part[channel, writes].append(one)
        for stage in stages:
            self._take_up(stage)
        self._readers: dict[str, list[tuple[int, Spot]]] = defaultdict(list)
        for k, stage in enumerate(stages):
            for spot in sorted(stage.spots):
                for net in self.move(spot).reads:
                    self._readers[net].append((k, spot))
        self._free: dict[tuple[int, Spot], set[int]] = {}

    def move(self, spot: Spot) -> Move:
        """What is handed on at a spot."""
        move = self._behaviours[spot[0]].thread.places[spot[1]].move
        assert move is not None
        return move

    def leaf(self, spot: Spot) -> str:
        """The law that computes there, if one does."""
        return self._behaviours[spot[0]].thread.places[spot[1]].leaf

    def hops(self, at: int, spot: Spot) -> Iterator[Hop]:
        """Where what is handed on there by a stage goes."""
        stage = self._stages[at]
        for net in sorted(self.move(spot).writes):
            if net in self.periods:
                continue
            for to, other in self._readers.get(net, ()):
                if to == at:
                    yield self._within(at, net, spot, other)
                elif self._run_together(stage, self._stages[to]) and self._takes(net, to, other):
                    yield Hop(to, other, in_sample=False, waits=self._until_taken(net, stage, self._stages[to], other))

    def is_in_order(self, at: int, first: Spot, then: Spot) -> bool:
        """Whether of two spots of a thread the second is never passed in a sample before the first."""
        key = at, first
        if key not in self._free:
            stage, ways = self._stages[at], self._behaviours[first[0]].ways
            found: set[int] = set()
            for job in stage.jobs[first[0]]:
                assert job.offer is not None
                period = job.offer.period if job.offer.kind == "sample" else 0
                found |= ways.reachable([job.offer.target], period, first[1])
            self._free[key] = found
        return then[1] not in self._free[key]

    def _within(self, at: int, net: str, spot: Spot, other: Spot) -> Hop:
        if spot[0] == other[0]:
            stage, in_order = self._stages[at], self.is_in_order(at, spot, other)
            return Hop(at, other, in_order, 0 if in_order else stage.period + stage.response)
        late = self._kind(net) == "overwrite"
        return Hop(at, other, in_sample=True, waits=self._pick_up(other[0]) if late else 0)

    def _takes(self, net: str, to: int, spot: Spot) -> bool:
        """Whether a stage takes what another one has handed on. From a channel each takes what began its own work."""
        return self._kind(net) == "var" or spot not in self._stages[to].taken

    def _until_taken(self, net: str, stage: Stage, to: Stage, spot: Spot) -> int:
        """Who writes is done a response after its sample. In a rendezvous within a sample of who reads, that has the
        value then; otherwise it lies there until the next value comes, and in a buffer of which a sample takes one
        until those before it have been taken.
        """
        kind = self._kind(net)
        if kind == "var" or spot in to.taken:
            return stage.period + stage.response
        if kind == "buffer":
            return stage.period + stage.response + self._capacities[net] * to.period
        return stage.response

    def _kind(self, net: str) -> ChannelKind:
        return self._kinds.get(net, "var")

    def _pick_up(self, thread: int) -> int:
        """How long a thread takes to come to what lies there for it."""
        return max((stage.response for stage in self._stages if stage.mode[0] == thread), default=0)

    @staticmethod
    def _run_together(one: Stage, other: Stage) -> bool:
        return one.mode[0] != other.mode[0] or one.mode == other.mode

    def _take_up(self, stage: Stage) -> None:
        """Add what the stage begins in loops that take values between their own samples, and what that begins."""
        pending = [(number, job) for number, jobs in stage.jobs.items() for job in jobs]
        while pending:
            number, begins = pending.pop()
            for channel, writes, _ in begun_by(self._behaviours[number], begins):
                for one in self._taking_part.get((channel, not writes), ()):
                    if not one.has_samples or one.number == stage.mode[0]:
                        continue
                    for job in one.jobs_on(channel, writes=not writes):
                        if job not in stage.jobs[one.number]:
                            stage.jobs[one.number].append(job)
                            spots = {(one.number, place) for place in job.path.moves}
                            stage.spots |= spots
                            stage.taken |= spots
                            pending.append((one.number, job))
