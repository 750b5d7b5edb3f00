"""How values flow from place to place within the samples of loops, and from one loop to another."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from cspdiag.analyses.timing.flow.behaviours import Behaviour
from cspdiag.analyses.timing.flow.demands import triggered_by
from cspdiag.analyses.timing.flow.paths import Job
from cspdiag.analyses.timing.threads.graph import Move
from cspdiag.analyses.timing.threads.offers import capacities
from cspdiag.base.record import record
from cspdiag.network.ir.network import ChannelKind, CoreNetwork

Location = tuple[int, int]
"""A place of a thread: the numbers of the thread and of the place."""


@dataclass
class Stage:
    """A sampled loop on the path of a value, which it passes on at ``locations``.

    At those in ``triggered`` another thread does work that this loop begins, between its own samples. ``mode`` is the
    thread of the loop, and the cycle in it.
    """

    period: int
    response: int
    mode: tuple[int, int]
    steady: frozenset[str] = frozenset()
    """The outputs that it is certain to write in each of its samples, as long as the program runs."""
    locations: set[Location] = field(default_factory=set)
    triggered: set[Location] = field(default_factory=set)
    jobs: dict[int, list[Job]] = field(default_factory=lambda: defaultdict(list))
    """By thread, the jobs that these locations are part of."""


@record
class Hop:
    """A value's step from one location to the next: within the same sample, or to a sample of the stage ``to``.

    ``waits`` is the longest time from the sample until that stage has the value; within the same sample, how long the
    value may lie in a channel.
    """

    to: int
    location: Location
    in_sample: bool
    waits: int = 0


class ValueFlow:
    """Where the values go that stages pass on."""

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
            self._add_triggered(stage)
        self._readers: dict[str, list[tuple[int, Location]]] = defaultdict(list)
        for k, stage in enumerate(stages):
            for location in sorted(stage.locations):
                for net in self.move_at(location).reads:
                    self._readers[net].append((k, location))
        self._free: dict[tuple[int, Location], set[int]] = {}

    def move_at(self, location: Location) -> Move:
        """What is passed on at a location."""
        move = self._behaviours[location[0]].thread.places[location[1]].move
        assert move is not None
        return move

    def law_at(self, location: Location) -> str:
        """The law that computes at a location; empty where none does."""
        return self._behaviours[location[0]].thread.places[location[1]].leaf

    def hops(self, at: int, location: Location) -> Iterator[Hop]:
        """Where the values go that a stage passes on at a location."""
        stage = self._stages[at]
        for net in sorted(self.move_at(location).writes):
            if net in self.periods:
                continue
            for to, other in self._readers.get(net, ()):
                if to == at:
                    yield self._within(at, net, location, other)
                elif self._can_run_together(stage, self._stages[to]) and self._takes(net, to, other):
                    yield Hop(to, other, in_sample=False, waits=self._until_taken(net, stage, self._stages[to], other))

    def is_in_order(self, at: int, first: Location, then: Location) -> bool:
        """Whether within a sample a thread never passes ``then`` before ``first``."""
        key = at, first
        if key not in self._free:
            stage, search = self._stages[at], self._behaviours[first[0]].search
            found: set[int] = set()
            for job in stage.jobs[first[0]]:
                assert job.offer is not None
                period = job.offer.period if job.offer.kind == "sample" else 0
                found |= search.reachable([job.offer.target], period, first[1])
            self._free[key] = found
        return then[1] not in self._free[key]

    def _within(self, at: int, net: str, location: Location, other: Location) -> Hop:
        if location[0] == other[0]:
            stage, in_order = self._stages[at], self.is_in_order(at, location, other)
            return Hop(at, other, in_order, 0 if in_order else stage.period + stage.response)
        late = self._kind(net) == "overwrite"
        return Hop(at, other, in_sample=True, waits=self._pick_up_time(other[0]) if late else 0)

    def _takes(self, net: str, to: int, location: Location) -> bool:
        """Whether a stage takes a value that another one passes on. What a channel triggers takes the value in its own
        stage.
        """
        return self._kind(net) == "var" or location not in self._stages[to].triggered

    def _until_taken(self, net: str, stage: Stage, to: Stage, location: Location) -> int:
        """The longest time from a sample of the writer until the reader has the value.

        The writer is done a response time after its sample. After a rendezvous within a sample the reader has the value
        at once. Otherwise the value waits for the reader's next sample, in a buffer until all values before it have
        been taken, one in each sample.
        """
        kind = self._kind(net)
        if kind == "var" or location in to.triggered:
            return stage.period + stage.response
        if kind == "buffer":
            return stage.period + stage.response + self._capacities[net] * to.period
        return stage.response

    def _kind(self, net: str) -> ChannelKind:
        return self._kinds.get(net, "var")

    def _pick_up_time(self, thread: int) -> int:
        """How long a thread takes at most to reach a value that is there for it."""
        return max((stage.response for stage in self._stages if stage.mode[0] == thread), default=0)

    @staticmethod
    def _can_run_together(one: Stage, other: Stage) -> bool:
        return one.mode[0] != other.mode[0] or one.mode == other.mode

    def _add_triggered(self, stage: Stage) -> None:
        """Add the jobs that the stage triggers in other loops, between their own samples, and the jobs that these
        trigger.
        """
        pending = [(number, job) for number, jobs in stage.jobs.items() for job in jobs]
        while pending:
            number, begins = pending.pop()
            for channel, writes, _ in triggered_by(self._behaviours[number], begins):
                for one in self._taking_part.get((channel, not writes), ()):
                    if not one.has_samples or one.number == stage.mode[0]:
                        continue
                    for job in one.jobs_begun_by(channel, writes=not writes):
                        if job not in stage.jobs[one.number]:
                            stage.jobs[one.number].append(job)
                            locations = {(one.number, place) for place in job.path.moves}
                            stage.locations |= locations
                            stage.triggered |= locations
                            pending.append((one.number, job))
