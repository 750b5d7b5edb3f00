"""What a thread does from one wait to the next: the longest path, and its longest step."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from cspdiag.analyses.timing.flow import Offer, Thread
from cspdiag.diagnostics import Span
from cspdiag.model.graphs import components

Reads = frozenset[tuple[str, str, int]]
State = tuple[int, Reads]


class UnboundedError(Exception):
    """The work between two waits has no bound; ``span`` is the place of the loop."""

    def __init__(self, reason: str, span: Span) -> None:
        super().__init__(reason)
        self.reason = reason
        self.span = span


@dataclass(slots=True)
class Path:
    """The most that any way from here to the next wait takes: all work, the part before the first switch to another thread, the longest step after it, the
    number of switches, of delays and how long these are together, of communications for each channel and side (``meets`` where it waits for them, ``gives`` where it does not), the waits that it may come to, the laws that compute on the way, and
    the outputs that are written, and the places that hand values on. ``least`` is the work that every way takes, ``is_only`` where there is but one.
    """

    work: int = 0
    least: int = 0
    first: int = 0
    later: int = 0
    switches: int = 0
    delays: int = 0
    delayed: int = 0
    meets: dict[tuple[str, bool], int] = field(default_factory=dict)
    gives: dict[str, int] = field(default_factory=dict)
    stops: frozenset[int] = frozenset()
    heaviest: tuple[int, str] = (0, "")
    leaves: frozenset[str] = frozenset()
    outputs: frozenset[str] = frozenset()
    moves: frozenset[int] = frozenset()
    is_only: bool = True

    @property
    def step(self) -> int:
        """The longest step."""
        return max(self.first, self.later)

    def communications(self) -> Iterator[tuple[str, bool, int]]:
        """Of each channel and side how often it communicates at most, whether it waits for that or not."""
        yield from ((channel, writes, count) for (channel, writes), count in self.meets.items())
        yield from ((channel, True, count) for channel, count in self.gives.items())


@dataclass(frozen=True, slots=True)
class Job:
    """What a thread does when a wait is over: where it waited, for what, and the path from there."""

    wait: int
    offer: Offer | None
    path: Path


class Jobs:
    """The jobs of one thread. ``delays`` are waits for time that are part of a job; with ``meets`` rendezvous are part of one."""

    def __init__(self, thread: Thread, *, delays: frozenset[int] = frozenset(), meets: bool = True) -> None:
        self.thread = thread
        self.delays = delays
        self.meets = meets

    def all(self) -> list[Job]:
        """The job from the beginning, and one for each offer of each wait."""
        found = [Job(-1, None, self._path(self.thread.entry, 0, frozenset()))]
        for number, place in enumerate(self.thread.places):
            if number in self.delays or not place.offers or (self.meets and not place.is_idle):
                continue
            for offer in place.offers:
                reads = _taken(frozenset(), offer) if offer.kind == "sample" else frozenset()
                period = offer.period if offer.kind == "sample" else 0
                found.append(Job(number, offer, self._path(offer.target, period, reads)))
        return found

    def reachable(self, starts: Iterable[int], period: int, avoided: int) -> set[int]:
        """The places that a job may come to from some without passing another one, if all samples of its period are there."""
        reached = {start for start in starts if start != avoided}
        pending = list(reached)
        while pending:
            for (number, _), _, _, _ in self._following((pending.pop(), frozenset()), period):
                if number != avoided and number not in reached:
                    reached.add(number)
                    pending.append(number)
        return reached

    def _path(self, start: int, period: int, reads: Reads) -> Path:
        done: dict[State, Path] = {}
        open_: set[State] = set()
        pending: list[tuple[State, bool]] = [((start, reads), False)]
        while pending:
            state, is_left = pending.pop()
            if is_left:
                open_.discard(state)
                done[state] = self._combined(state, period, done)
                continue
            if state in done or state in open_:
                continue
            open_.add(state)
            pending.append((state, True))
            for following, _, _, _ in self._following(state, period):
                if following in open_:
                    self._check_loop(state, following, period)
                elif following not in done:
                    pending.append((following, False))
        return done[start, reads]

    def _check_loop(self, state: State, back: State, period: int) -> None:
        """A way back without any wait: without work it is no matter, otherwise nobody knows how often it is gone."""
        inside, pending = {back}, [back]
        while pending:
            for following, _, _, _ in self._following(pending.pop(), period):
                if following not in inside:
                    inside.add(following)
                    pending.append(following)
        cyclic = [self.thread.places[number] for number, _ in inside if self._comes_back((number, _), back, period)]
        if any(place.cost or place.offers for place in cyclic):
            place = self.thread.places[back[0]]
            raise UnboundedError(
                "how often this repeats before it waits for a sample or an event cannot be seen", place.span
            )

    def _comes_back(self, state: State, goal: State, period: int) -> bool:
        seen, pending = {state}, [state]
        while pending:
            for following, _, _, _ in self._following(pending.pop(), period):
                if following == goal:
                    return True
                if following not in seen:
                    seen.add(following)
                    pending.append(following)
        return False

    def _following(self, state: State, period: int) -> Iterator[tuple[State, int, bool, Offer | None]]:
        """Where it goes on without stopping: the state, the delay on the way, whether others may run meanwhile, and the communication."""
        number, reads = state
        place = self.thread.places[number]
        if not place.offers:
            if place.starts:
                reads = frozenset(key for key in reads if key[1] != place.starts) | {(_FRESH, place.starts, 0)}
            yield from (((target, reads), 0, place.breaks, None) for target in place.successors)
            return
        available = [
            offer for offer in place.offers
            if offer.kind == "sample" and period and offer.period == period and _is_there(offer, reads)
        ]  # fmt: skip
        if available:
            for offer in available:
                yield (offer.target, _taken(reads, offer)), 0, False, None
        elif number in self.delays:
            longest = max(offer.period for offer in place.offers if offer.kind == "delay")
            yield from (((offer.target, reads), longest, True, None) for offer in place.offers)
        elif self.meets and not place.is_idle:
            yield from (((offer.target, reads), 0, True, offer) for offer in place.offers)

    def _combined(self, state: State, period: int, done: dict[State, Path]) -> Path:
        number, _ = state
        place = self.thread.places[number]
        path = Path()
        ways = 0
        least: list[int] = []
        for following, delay, switches, offer in self._following(state, period):
            ways += 1
            after = done.get(following)
            if after is None:
                path.is_only = False
                continue  # Around a loop without work.
            path.is_only &= after.is_only and ways == 1
            least.append(after.least)
            path.work = max(path.work, after.work)
            path.delayed = max(path.delayed, after.delayed + delay)
            path.first = max(path.first, 0 if switches else after.first)
            path.later = max(path.later, after.step if switches else after.later)
            path.switches = max(path.switches, after.switches + switches)
            path.delays = max(path.delays, after.delays + (delay > 0))
            path.stops |= after.stops
            path.leaves |= after.leaves
            path.outputs |= after.outputs
            path.moves |= after.moves
            path.heaviest = max(path.heaviest, after.heaviest, key=lambda part: part[0])
            for channel, count in after.meets.items():
                path.meets[channel] = max(
                    path.meets.get(channel, 0), count + (offer is not None and channel == (offer.channel, offer.writes))
                )
            for net, count in after.gives.items():
                path.gives[net] = max(path.gives.get(net, 0), count)
            if offer is not None:
                path.meets.setdefault((offer.channel, offer.writes), 1)
        if not ways and place.offers:
            path.stops = frozenset([number])
        for net in place.gives:
            path.gives[net] = path.gives.get(net, 0) + 1
        path.work += place.cost
        path.least = min(least, default=0) + place.cost
        path.outputs |= set(place.outputs)
        if place.move is not None:
            path.moves |= {number}
        path.first += place.cost
        if place.leaf:
            path.leaves |= {place.leaf}
        if place.leaf and place.cost >= path.heaviest[0]:
            path.heaviest = (place.cost, place.leaf)
        return path


_FRESH, _GROUP = "fresh", "group"
"""Among what was read: processes that have begun and read nothing, and parallels in which something was read."""


def _is_there(offer: Offer, reads: Reads) -> bool:
    """Whether the sample of the present tick is still to be had: not by who took it already, nor by a process that has only just begun,
    unless it waited for the tick beside another branch.
    """
    if offer.key in reads:
        return False
    return (_FRESH, offer.key[1], 0) not in reads or any((_GROUP, "", group) in reads for group in offer.groups)


def _taken(reads: Reads, offer: Offer) -> Reads:
    if not offer.takes:
        return reads
    return reads - {(_FRESH, offer.key[1], 0)} | {offer.key} | {(_GROUP, "", group) for group in offer.groups}


def cycles(stops: dict[int, frozenset[int]]) -> list[frozenset[int]]:
    """Sets of waits that a thread may come back to from each other; ``stops`` leads from each wait to the next ones."""
    found = components(stops, lambda wait: sorted(stops.get(wait, ())))
    return [frozenset(group) for group in found if len(group) > 1 or group[0] in stops.get(group[0], ())]
