"""What each thread asks of the processor: its jobs, how often each may come, and the partners that a job waits for."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from cspdiag.analyses.timing.flow import Place, Thread
from cspdiag.analyses.timing.jobs import Job, Jobs, UnboundedError, cycles
from cspdiag.analyses.timing.result import Refusal
from cspdiag.model.durations import duration

ONCE = 2**60
"""The period of what happens at most once, in nanoseconds: longer than any program runs."""


@dataclass(frozen=True, slots=True)
class Demand:
    """Recurring work of a thread at a level of priority. ``origin`` is the thread whose samples cause it, -1 for none; ``late`` tells that it comes
    only when that one has communicated.
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


@dataclass(slots=True)
class Behaviour:
    """A thread with its jobs; ``waits`` are those that it can come to, ``loop_of`` the cycle that each is part of."""

    number: int
    thread: Thread
    level: int
    jobs: list[Job]
    waits: frozenset[int]
    loop_of: dict[int, int]
    has_samples: bool
    ways: Jobs

    def at(self, wait: int) -> Iterator[Job]:
        """The jobs that begin at a wait."""
        return (job for job in self.jobs if job.wait == wait)

    def idle_waits(self) -> Iterator[tuple[int, Place]]:
        """The waits at which time may pass whatever others do."""
        return ((wait, self.thread.places[wait]) for wait in sorted(self.waits) if self.thread.places[wait].is_idle)

    def jobs_on(self, channel: str, *, writes: bool) -> list[Job]:
        """The jobs that a communication begins."""
        return [
            job
            for job in self.jobs
            if job.wait in self.waits
            and job.offer is not None
            and job.offer.kind == "partner"
            and (job.offer.channel, job.offer.writes) == (channel, writes)
        ]


def behaviour(number: int, thread: Thread, level: int, refusals: list[Refusal]) -> Behaviour | None:
    """How a thread goes from wait to wait; None where its work has no bound, which is told."""
    samples = thread.has_samples()
    try:
        ways = Jobs(thread, meets=samples)
        jobs = ways.all()
        waits, loops = _loops(jobs)
        delays = frozenset(wait for loop in loops for wait in _delays_in(thread, loop))
        if delays:
            ways = Jobs(thread, delays=delays, meets=samples)
            jobs = ways.all()
            waits, loops = _loops(jobs)
    except UnboundedError as problem:
        refusals.append(
            Refusal(thread.path, problem.reason, problem.span, "let each round of the loop wait for a sample")
        )
        return None
    for loop in loops:
        refusals += _refused(thread, loop)
    loop_of = {wait: k for k, loop in enumerate(loops) for wait in loop}
    return Behaviour(number, thread, level, jobs, waits, loop_of, samples, ways)


def _loops(jobs: Sequence[Job]) -> tuple[frozenset[int], list[frozenset[int]]]:
    after: dict[int, frozenset[int]] = {}
    for job in jobs:
        after[job.wait] = after.get(job.wait, frozenset()) | job.path.stops
    waits: set[int] = set()
    pending = [-1]
    while pending:
        for wait in after.get(pending.pop(), ()):
            if wait not in waits:
                waits.add(wait)
                pending.append(wait)
    return frozenset(waits), cycles({wait: after.get(wait, frozenset()) for wait in waits})


def _periods(place: Place) -> frozenset[int]:
    return frozenset(offer.period for offer in place.offers if offer.kind == "sample")


def _delays_in(thread: Thread, loop: frozenset[int]) -> Iterator[int]:
    """Waits for time within a loop that follows samples: they are part of its work."""
    if not any(_periods(thread.places[wait]) for wait in loop):
        return
    for wait in loop:
        place = thread.places[wait]
        if not _periods(place) and any(offer.kind == "delay" for offer in place.offers):
            yield wait


def _refused(thread: Thread, loop: frozenset[int]) -> Iterator[Refusal]:
    """A loop that follows samples and waits for something else in between misses samples sooner or later."""
    places = [thread.places[wait] for wait in sorted(loop)]
    sampled = [place for place in places if _periods(place)]
    if not sampled:
        return
    for place in places:
        if not _periods(place) and place.is_idle:
            what = _awaited(place)
            yield Refusal(
                place.path, f"between its samples it waits for {what}, without bound", place.span,
                "wait for it in an alternative together with the sample, or in a parallel process",
            )  # fmt: skip
    common = frozenset.intersection(*(_periods(place) for place in sampled))
    if not common:
        shortest = min(min(_periods(place)) for place in sampled)
        longest = max(sampled, key=lambda place: max(_periods(place)))
        yield Refusal(
            longest.path, f"one loop waits for samples of {duration(shortest)} and of {duration(max(_periods(longest)))}, so that it misses the faster ones",
            longest.span, "read the slower input in an alternative with the faster one, or in a parallel process",
        )  # fmt: skip


def _awaited(place: Place) -> str:
    for offer in place.offers:
        if offer.kind == "event":
            return f"the event `{offer.channel.rpartition('.')[2]}`"
        if offer.kind == "join":
            return "parallel parts that loop"
        if offer.kind == "delay":
            return "time to pass"
    return "something else"


class Demands:
    """The demands of all threads, and those that threads cause in others by communicating with them.

    ``grid`` is the shortest time between two events of one input in nanoseconds, None where nothing tells.
    """

    def __init__(self, behaviours: Sequence[Behaviour], grid: int | None, refusals: list[Refusal]) -> None:
        self.behaviours = behaviours
        self.grid = grid
        self.own: dict[int, list[Demand]] = {}
        self._sides: dict[tuple[str, bool], dict[int, Behaviour]] = {}
        for one in behaviours:
            for place in one.thread.places:
                for offer in place.offers:
                    if offer.kind == "partner":
                        self._sides.setdefault((offer.channel, offer.writes), {})[one.number] = one
        self._activated: set[tuple[int, str, bool, int, int]] = set()
        for one in behaviours:
            self.own[one.number] = list(self._of(one, refusals))
        for one in behaviours:
            self._spread_from(one)

    def _of(self, one: Behaviour, refusals: list[Refusal]) -> Iterator[Demand]:
        for job in one.jobs:
            if job.wait >= 0 and job.wait not in one.waits:
                continue
            path = job.path
            if path.work == 0:
                continue
            period = self._period(job)
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
                one.number,
                one.level,
                period,
                path.work,
                path.step,
                path.delays,
                one.number if is_sample else -1,
                False,
                cause,
            )

    def _period(self, job: Job) -> int | None:
        """How often a job may come; 0 where that is unknown, None where partners decide."""
        if job.offer is None or job.offer.kind == "join":
            return ONCE
        match job.offer.kind:
            case "sample" | "delay":
                return job.offer.period
            case "event":
                return self.grid or 0
            case _:
                return None

    def _spread_from(self, one: Behaviour) -> None:
        """The communications in the jobs of a thread begin jobs in others, and these in others again."""
        pending: list[tuple[int, str, bool, int, int]] = []
        for job in one.jobs:
            period = self._period(job)
            if not period or (job.wait >= 0 and job.wait not in one.waits):
                continue
            pending += [(one.number, channel, writes, period, count) for channel, writes, count in begun_by(one, job)]
        while pending:
            entry = pending.pop()
            if entry in self._activated:
                continue
            self._activated.add(entry)
            number, channel, writes, period, count = entry
            for other in self.taking_part(channel, writes=not writes):
                if other.number == number:
                    continue
                jobs = other.jobs_on(channel, writes=not writes)
                for job in jobs:
                    pending += [
                        (other.number, met, side, period, count * times) for met, side, times in begun_by(other, job)
                    ]
                work = max((job.path.work for job in jobs), default=0)
                if work:
                    step = max(job.path.step for job in jobs)
                    # Each who communicates there begins the work once more.
                    cause = f"{channel} of {number}"
                    self.own[other.number].append(
                        Demand(other.number, other.level, period, count * work, step, 0, one.number, True, cause)
                    )

    def taking_part(self, channel: str, *, writes: bool) -> list[Behaviour]:
        """The threads that may communicate on a channel, on that side."""
        return list(self._sides.get((channel, writes), {}).values())

    def activators(self, channel: str, *, writes: bool) -> set[int]:
        """The threads that communicate on a channel, on that side."""
        return {number for number, other, side, _, _ in self._activated if (other, side) == (channel, writes)}


def _unknown_rate(one: Behaviour, job: Job) -> Refusal:
    """Work of which nobody knows how often it comes."""
    place = one.thread.places[max(job.wait, 0)]
    what, advice = "a delay of unknown length", "let how long it waits be a constant, longer than zero"
    if job.offer is not None and job.offer.kind == "event":
        what = f"the event `{job.offer.channel.rpartition('.')[2]}`"
        advice = "give the program an environment, whose `step` is the shortest time between two events"
    reason = f"it computes after {what}, and how often cannot be seen"
    return Refusal(job.path.heaviest[1] or place.path, reason, place.span, advice)


def begun_by(one: Behaviour, job: Job) -> Iterator[tuple[str, bool, int]]:
    """What a job communicates, and what a thread without samples then waits to communicate: channels and sides, and how often."""
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
    return replace(
        one, work=max(one.work, other.work), step=max(one.step, other.step), delays=max(one.delays, other.delays)
    )


def across(groups: Iterable[list[Demand]]) -> list[Demand]:
    """What one of several groups of threads demands at most: slot by slot the largest, the groups never being active together."""
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
