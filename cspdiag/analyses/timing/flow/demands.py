"""What each thread asks of the processor: how often each of its jobs may come, and what it causes in others."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import assert_never

from cspdiag.analyses.timing.flow.behaviours import Behaviour
from cspdiag.analyses.timing.flow.paths import Job
from cspdiag.analyses.timing.flow.restarts import round_period
from cspdiag.analyses.timing.refusal import Refusal
from cspdiag.analyses.timing.task import ONCE
from cspdiag.base.record import record, replaced

LARGEST_NUMBER_OF_COMMUNICATIONS = 1_000
"""On one channel in one period, before the search for what they begin is given up."""


@record
class Demand:
    """Recurring work of a thread at a level of priority. ``origin`` is the thread whose samples cause it, -1 for none;
    ``late`` tells that it comes only when that one has communicated. ``behind`` is how much later than at its period a
    job may come besides, since something was kept for it. For ``held`` the thread itself lets time pass in it, without
    using the processor.
    """

    thread: int
    level: int
    period: int
    work: int
    step: int
    delays: int = 0
    origin: int = -1
    late: bool = False
    cause: str = ""
    """What begins the work: of one cause only one job comes in a period."""
    behind: int = 0
    held: int = 0
    meets: int = 0
    """How many jobs in a period may wait for partners while samples are followed."""
    shared: frozenset[int] = frozenset()
    """Other threads whose work this may be instead."""


@record
class _Begun:
    """Communications that a thread makes, ``count`` in a period; ``hops`` threads came before it."""

    thread: int
    channel: str
    writes: bool
    period: int
    count: int
    hops: int
    behind: int


class Demands:
    """The demands of all threads, and those that threads cause in others by communicating with them.

    ``grid`` is the shortest time between two events of one input in nanoseconds, None where nothing tells.
    ``capacities`` are the numbers of values that channels hold, ``restarted`` the threads that may begin again, each
    with the shortest time between.
    """

    def __init__(
        self,
        behaviours: Sequence[Behaviour],
        grid: int | None,
        capacities: Mapping[str, int],
        restarted: Mapping[int, int],
        refusals: list[Refusal],
    ) -> None:
        self.behaviours = behaviours
        self.grid = grid
        self.own: dict[int, list[Demand]] = {}
        self._capacities = capacities
        self._restarted = restarted
        self._sides: dict[tuple[str, bool], dict[int, Behaviour]] = {}
        for one in behaviours:
            for place in one.thread.places:
                for offer in place.offers:
                    if offer.kind == "partner":
                        self._sides.setdefault(offer.end, {})[one.number] = one
        self._activated: set[tuple[int, str, bool, int, int]] = set()
        for one in behaviours:
            self.own[one.number] = list(self._of(one, refusals))
        for one in behaviours:
            self._spread_from(one, refusals)

    def _of(self, one: Behaviour, refusals: list[Refusal]) -> Iterator[Demand]:
        for job in one.jobs:
            path = job.path
            held = path.delayed if job.is_owed else 0
            if not (path.work or held or (path.meets and job.is_owed)):
                continue
            period = self._period(one, job)
            if period is None:
                continue
            if period == 0:
                refusals.append(_unknown_rate(one, job))
                continue
            is_sample = job.offer is not None and job.offer.kind == "sample"
            cause = (
                "" if is_sample else job.offer.channel if job.offer is not None and job.offer.channel else str(job.wait)
            )
            yield Demand(
                one.number, one.level, period, path.work, path.step, path.delays, one.number if is_sample else -1,
                False, cause,
                self._behind(one, job, period), held, int(bool(path.meets) and job.is_owed),
            )  # fmt: skip

    def _period(self, one: Behaviour, job: Job) -> int | None:
        """How often a job may come; 0 where that is unknown, None where partners decide."""
        if job.offer is None:
            return self._restarted.get(one.number, ONCE)
        if job.offer.kind in ("delay", "event") and job.wait not in one.loop_of:
            return self._restarted.get(one.number, ONCE)
        match job.offer.kind:
            case "join":
                if job.wait in one.loop_of:
                    return round_period(one, job.wait, self.grid)
                return self._restarted.get(one.number, ONCE)
            case "sample" | "delay":
                return job.offer.period
            case "event":
                return self.grid or 0
            case "partner":
                return None
            case _:
                assert_never(job.offer.kind)

    def _behind(self, one: Behaviour, job: Job, period: int) -> int:
        """By how much a job may come later than its period says."""
        if period == ONCE or (job.offer is not None and job.offer.kind == "sample"):
            return 0
        if job.offer is None or job.offer.kind == "join" or job.wait not in one.loop_of:
            return period
        if job.offer.kind == "event":
            # An event is kept until somebody asks for it.
            is_asked = one.thread.begins_at_once and one.is_prompt(job.offer.channel, writes=False)
            return 0 if is_asked else period
        # What it does after waiting on the way comes when it may.
        return period if job.offer.kind == "delay" and (job.path.meets or job.path.delays) else 0

    def _spread_from(self, one: Behaviour, refusals: list[Refusal]) -> None:
        """The communications in the jobs of a thread begin jobs in others, and these in others again."""
        pending: list[_Begun] = []
        for job in one.jobs:
            period = self._period(one, job)
            if period:
                is_sample = job.offer is not None and job.offer.kind == "sample"
                # Who follows no samples may have been kept from communicating for any time.
                behind = 0 if is_sample or period == ONCE else self._behind(one, job, period) + period
                pending += [
                    _Begun(one.number, channel, writes, period, count, 0 if is_sample else 1, behind)
                    for channel, writes, count in begun_by(one, job)
                ]
        while pending:
            begun = pending.pop()
            known = (begun.thread, begun.channel, begun.writes, begun.period, begun.count)
            if known in self._activated:
                continue
            if begun.count > LARGEST_NUMBER_OF_COMMUNICATIONS:
                refusals.append(_without_end(one, begun))
                return
            self._activated.add(known)
            for other in self.taking_part(begun.channel, writes=not begun.writes):
                if other.number != begun.thread:
                    pending += self._begin(one, begun, other)

    def _begin(self, one: Behaviour, begun: _Begun, other: Behaviour) -> Iterator[_Begun]:
        """What communications begin in who takes part in them."""
        jobs = other.jobs_on(begun.channel, writes=not begun.writes)
        behind = self._kept(begun, other)
        work = max((job.path.work for job in jobs), default=0)
        held = max((job.path.delayed for job in jobs if job.is_owed), default=0)
        meets = any(job.path.meets and job.is_owed for job in jobs)
        if work or held or meets:
            step = max(job.path.step for job in jobs)
            # Each who communicates there begins the work once more.
            self.own[other.number].append(
                Demand(
                    other.number, other.level, begun.period, begun.count * work, step,
                    begun.count * max(job.path.delays for job in jobs),
                    one.number, True, f"{begun.channel} of {begun.thread}", behind, begun.count * held,
                    begun.count * meets,
                )
            )  # fmt: skip
        for job in jobs:
            for met, side, times in begun_by(other, job):
                yield _Begun(other.number, met, side, begun.period, begun.count * times, begun.hops + 1, behind)

    def _kept(self, begun: _Begun, other: Behaviour) -> int:
        """By how much communications may be behind when they begin jobs in another thread."""
        if begun.period == ONCE or other.is_prompt(begun.channel, writes=not begun.writes):
            return begun.behind
        kept = self._capacities.get(begun.channel, 0)
        if begun.hops == 0:
            # Who follows samples waits until its value is taken, or it lies in the channel.
            return begun.period * (kept + 1) if kept else 0
        return begun.period * (len(self.behaviours) + sum(self._capacities.values()) + 2)

    def taking_part(self, channel: str, *, writes: bool) -> list[Behaviour]:
        """The threads that may communicate on a channel, on that side."""
        return list(self._sides.get((channel, writes), {}).values())

    def activators(self, channel: str, *, writes: bool) -> set[int]:
        """The threads that communicate on a channel, on that side."""
        return {number for number, other, side, _, _ in self._activated if (other, side) == (channel, writes)}


def _without_end(one: Behaviour, begun: _Begun) -> Refusal:
    """Communications that seem to begin others, and these more of them."""
    name = begun.channel.rpartition(".")[2]
    return Refusal(
        one.thread.path,
        f"how often it makes others communicate on `{name}` in a period cannot be bounded",
        one.thread.places[one.thread.entry].span,
        f"let who reads or writes `{name}` do so once in each of its rounds",
    )


def _unknown_rate(one: Behaviour, job: Job) -> Refusal:
    """Work of which nobody knows how often it comes."""
    place = one.thread.places[max(job.wait, 0)]
    what, advice = "a delay of unknown length", "let how long it waits be a constant, longer than zero"
    if job.offer is not None and job.offer.kind == "event":
        what = f"the event `{job.offer.channel.rpartition('.')[2]}`"
        advice = "give the program an environment, whose `step` is the shortest time between two events"
    elif job.offer is None or job.offer.kind == "join":
        what = "parallel parts that begin and end again"
        advice = "let each round around them wait for a sample, an event or a constant time"
    reason = f"it computes after {what}, and how often cannot be seen"
    return Refusal(job.path.heaviest[1] or place.path, reason, place.span, advice)


def begun_by(one: Behaviour, job: Job) -> Iterator[tuple[str, bool, int]]:
    """What a job communicates, and what a thread without samples then waits to communicate: channels and sides, and how
    often.
    """
    yield from job.path.communications()
    for stop in job.path.stops:
        if not one.thread.places[stop].is_idle:
            for offer in one.thread.places[stop].offers:
                yield offer.channel, offer.writes, 1


def merged(alternatives: Iterable[Sequence[Demand]]) -> list[Demand]:
    """What any of some alternatives demands at most, of which one is active at a time.

    Samples of one period in a thread exclude each other too, since it runs one mode after another.
    """
    most: dict[tuple[int, int, int, str], Demand] = {}
    for demands in alternatives:
        for part in demands:
            key = (part.level, part.period, part.thread, part.cause)
            known = most.get(key)
            most[key] = part if known is None else _larger(known, part)
    return list(most.values())


def _larger(one: Demand, other: Demand) -> Demand:
    shared = one.shared | other.shared | ({other.thread} if other.thread != one.thread else set())
    return replaced(
        one, origin=one.origin if one.origin == other.origin or not one.late else -1, shared=shared,
        work=max(one.work, other.work), step=max(one.step, other.step), delays=max(one.delays, other.delays),
        behind=max(one.behind, other.behind), held=max(one.held, other.held), meets=max(one.meets, other.meets),
    )  # fmt: skip


def across(groups: Iterable[list[Demand]]) -> list[Demand]:
    """What one of several groups of threads demands at most: slot by slot the largest, the groups never being active
    together.
    """
    slots: dict[tuple[int, int, bool], list[Demand]] = {}
    for group in groups:
        own: dict[tuple[int, int, bool], list[Demand]] = {}
        for part in group:
            own.setdefault((part.level, part.period, part.late), []).append(part)
        for key, parts in own.items():
            known = slots.setdefault(key, [])
            for k, part in enumerate(sorted(parts, key=lambda part: -part.work)):
                if k < len(known):
                    known[k] = _larger(known[k], part)
                else:
                    known.append(part)
    return [part for parts in slots.values() for part in parts]
