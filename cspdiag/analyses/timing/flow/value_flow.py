"""How values flow from place to place within the samples of loops, and from one loop to another."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from cspdiag.analyses.timing.flow.behaviours import Behaviour
from cspdiag.analyses.timing.flow.demands import triggered_by
from cspdiag.analyses.timing.flow.paths import Job
from cspdiag.analyses.timing.flow.steady import passed_by_partners
from cspdiag.analyses.timing.threads.graph import Move
from cspdiag.analyses.timing.threads.offers import capacities
from cspdiag.base import Span
from cspdiag.base.graphs import reached
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
    while_loops: dict[range, frozenset[int]] = field(default_factory=dict)
    """By the places of each loop around its waits, those where it passes values on in each sample while that lasts."""
    certain: frozenset[Location] = frozenset()
    """Where it or a partner does so."""
    lasting: frozenset[Location] = frozenset()
    """Where it does so as long as the program runs."""
    locations: set[Location] = field(default_factory=set)
    triggered: set[Location] = field(default_factory=set)
    jobs: dict[int, list[Job]] = field(default_factory=lambda: defaultdict(list))
    """By thread, the jobs that these locations are part of."""


@record
class Hop:
    """A value's step from one location to the next: within the same sample, or to a sample of the stage ``to``.

    ``waits`` is the longest time from the sample until that stage has the value; within the same sample, how long the
    value may lie in a channel. ``kept`` is the net that may keep an older value, None if that is none.
    """

    to: int
    location: Location
    in_sample: bool
    waits: int = 0
    kept: str | None = None


class ValueFlow:
    """Where the values go that stages pass on. The threads in ``pausing`` may end or be ended while others continue."""

    def __init__(
        self,
        network: CoreNetwork,
        behaviours: Mapping[int, Behaviour],
        stages: Sequence[Stage],
        pausing: Collection[int],
    ) -> None:
        self._behaviours = behaviours
        self._stages = stages
        self._pausing = pausing
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
            partners = [number for number in stage.jobs if number not in pausing]
            stage.certain = passed_by_partners(behaviours, partners, stage.certain, self._kinds)
            stage.lasting = passed_by_partners(behaviours, partners, stage.lasting, self._kinds)
        self._readers: dict[str, list[tuple[int, Location]]] = defaultdict(list)
        self._writers: dict[str, set[Location]] = defaultdict(set)
        for k, stage in enumerate(stages):
            for location in sorted(stage.locations):
                for net in self.move_at(location).reads:
                    self._readers[net].append((k, location))
                for net in self.move_at(location).writes:
                    self._writers[net].add(location)
        self._free: dict[tuple[int, Location], set[int]] = {}
        self._written_before: dict[tuple[int, str, Location], bool] = {}

    def move_at(self, location: Location) -> Move:
        """What is passed on at a location."""
        move = self._behaviours[location[0]].thread.places[location[1]].move
        assert move is not None
        return move

    def span_at(self, location: Location) -> Span:
        """Where the text says what is passed on at a location."""
        return self._behaviours[location[0]].thread.places[location[1]].span

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
                    yield from self._within(at, net, location, other)
                elif self._can_run_together(stage, self._stages[to]) and self._takes(net, to, other):
                    waits = self._until_taken(net, stage, self._stages[to], other)
                    yield Hop(to, other, in_sample=False, waits=waits, kept=self._kept(net, at, to, other))

    def is_in_order(self, at: int, first: Location, then: Location) -> bool:
        """Whether within a sample a thread never passes ``then`` before ``first``."""
        key = at, first
        if key not in self._free:
            stage, search = self._stages[at], self._behaviours[first[0]].search
            found: set[int] = set()
            for job in stage.jobs[first[0]]:
                assert job.offer is not None
                period = job.offer.period if job.offer.kind == "sample" else 0
                found |= search.reachable([job.offer.target], period, {first[1]})
            self._free[key] = found
        return then[1] not in self._free[key]

    def _within(self, at: int, net: str, location: Location, other: Location) -> Iterator[Hop]:
        stage, is_variable = self._stages[at], self._kind(net) == "var"
        if location[0] != other[0]:
            late = self._pick_up_time(other[0]) if self._kind(net) == "overwrite" else 0
            yield Hop(
                at, other, in_sample=True, waits=late, kept=self._kept(net, at, at, other) if is_variable else None
            )
        elif is_variable and self._is_written_before(at, net, other):
            one = self._behaviours[location[0]]
            if other[1] in one.search.reachable(one.thread.places[location[1]].successors[:1], stage.period, ()):
                yield Hop(at, other, in_sample=True)
        elif self.is_in_order(at, location, other) and not is_variable:
            yield Hop(at, other, in_sample=True)
        elif self._may_come_later(stage, location, other):
            late = stage.period + stage.response
            yield Hop(at, other, in_sample=False, waits=late, kept=self._kept(net, at, at, other))

    def _is_written_before(self, at: int, net: str, reader: Location) -> bool:
        """Whether within each sample the thread of a reader writes a variable before it reads it, on every path."""
        key = at, net, reader
        if key not in self._written_before:
            stage, one = self._stages[at], self._behaviours[reader[0]]
            places = one.thread.places
            writers = {number for thread, number in self._writers[net] if thread == reader[0]} - {reader[1]}
            # A fault may come before the write; of a process written by hand nothing is known.
            begins = [
                target
                for number in writers
                if not places[number].is_by_hand
                for target in places[number].successors[1:]
            ]
            offers = [job.offer for job in stage.jobs[reader[0]] if job.offer is not None]
            begins += [offer.target for offer in offers]
            self._written_before[key] = reader[1] not in one.search.reachable(begins, stage.period, writers)
        return self._written_before[key]

    def _may_come_later(self, stage: Stage, first: Location, then: Location) -> bool:
        """Whether a thread may pass ``then`` after another wait than ``first``, and later."""
        one = self._behaviours[first[0]]
        after = one.next_waits()
        begins = {wait for job in one.jobs if first[1] in job.path.moves for wait in job.path.stops}
        waits = set(reached(sorted(begins), lambda wait: sorted(after.get(wait, ()))))
        return any(job.wait in waits and then[1] in job.path.moves for job in stage.jobs[first[0]])

    def _kept(self, net: str, at: int, to: int, reader: Location) -> str | None:
        """The net, if a stage that writes it at one sample may leave an older value there for the reader at another."""
        stage, reads = self._stages[at], self._stages[to]
        is_written = any(
            location in stage.lasting or self._is_in_loop_of(stage, location, reader)
            for location in self._writers[net]
            if location in stage.locations
        )
        is_taken = self._kind(net) == "var" or reader in reads.certain
        return None if is_written and is_taken else net

    def _is_in_loop_of(self, stage: Stage, writer: Location, reader: Location) -> bool:
        """Whether a reader runs only while a loop of its thread lasts that passes a writer in each sample."""
        return (
            writer[0] == reader[0] == stage.mode[0]
            and writer[0] not in self._pausing
            and any(writer[1] in passed and reader[1] in loop for loop, passed in stage.while_loops.items())
        )

    def is_written_elsewhere(self, at: int, location: Location, net: str) -> bool:
        """Whether a loop may write a variable or an output at other places too, and so replace a value."""
        stage = self._stages[at]
        loops = [loop for loop in stage.while_loops if location[1] in loop and location[0] == stage.mode[0]]
        return self._kind(net) in ("var", "overwrite") and any(
            other != location
            and other in stage.locations
            and (other[0] != location[0] or not loops or any(other[1] in loop for loop in loops))
            for other in self._writers[net]
        )

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
