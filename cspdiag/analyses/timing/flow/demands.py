"""What each thread demands of the processor: how often its jobs are released, and which work it triggers in other
threads.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import assert_never

from cspdiag.analyses.timing.flow.behaviours import Behaviour
from cspdiag.analyses.timing.flow.paths import Job
from cspdiag.analyses.timing.flow.restarts import shortest_iteration
from cspdiag.analyses.timing.refusal import Refusal
from cspdiag.analyses.timing.task import ONCE
from cspdiag.base.record import record, replaced

LARGEST_NUMBER_OF_COMMUNICATIONS = 1_000
"""On one channel in one period; with more of them the search for what they trigger is given up."""


@record
class Demand:
    """Recurring work of a thread at a priority level.

    ``origin`` is the thread whose samples cause it, -1 if there is none; ``is_triggered`` says that it is released only
    when that thread has communicated. ``jitter`` is the release jitter besides this, ``suspension`` the time that the
    thread itself lets pass in a job without using the processor.
    """

    thread: int
    level: int
    period: int
    work: int
    step: int
    delays: int = 0
    origin: int = -1
    is_triggered: bool = False
    cause: str = ""
    """What releases the work: each cause releases one job in a period."""
    jitter: int = 0
    suspension: int = 0
    meets: int = 0
    """The number of jobs in a period that may wait for partners while samples are followed."""
    shared_with: frozenset[int] = frozenset()
    """Other threads, of which one may do this work instead."""


@record
class _Trigger:
    """Communications of a thread that may begin work in others: ``count`` in a period, at the end of a chain of
    ``hops`` threads.
    """

    thread: int
    channel: str
    writes: bool
    period: int
    count: int
    hops: int
    jitter: int


class Demands:
    """The demands of all threads, with the work that they trigger in each other by communicating.

    ``grid`` is the shortest time between two events of one input in nanoseconds, None where it is unknown.
    ``capacities`` are the numbers of values that channels hold; ``restarted`` are the threads that may begin again,
    each with the shortest time between two starts.
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
        self.by_thread: dict[int, list[Demand]] = {}
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
            self.by_thread[one.number] = list(self._own_demands(one, refusals))
        for one in behaviours:
            self._propagate_from(one, refusals)

    def _own_demands(self, one: Behaviour, refusals: list[Refusal]) -> Iterator[Demand]:
        for job in one.jobs:
            path = job.path
            suspension = path.delay_time if job.follows_samples else 0
            if not (path.work or suspension or (path.meets and job.follows_samples)):
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
                self._jitter(one, job, period), suspension, int(bool(path.meets) and job.follows_samples),
            )  # fmt: skip

    def _period(self, one: Behaviour, job: Job) -> int | None:
        """The shortest time between two releases of a job; 0 where it is unknown, None where partners determine it."""
        if job.offer is None:
            return self._restarted.get(one.number, ONCE)
        if job.offer.kind in ("delay", "event") and job.wait not in one.loop_of:
            return self._restarted.get(one.number, ONCE)
        match job.offer.kind:
            case "join":
                if job.wait in one.loop_of:
                    return shortest_iteration(one, job.wait, self.grid)
                return self._restarted.get(one.number, ONCE)
            case "sample" | "delay":
                return job.offer.period
            case "event":
                return self.grid or 0
            case "partner":
                return None
            case _:
                assert_never(job.offer.kind)

    def _jitter(self, one: Behaviour, job: Job, period: int) -> int:
        """By how much a job may be released later than its period says."""
        if period == ONCE or (job.offer is not None and job.offer.kind == "sample"):
            return 0
        if job.offer is None or job.offer.kind == "join" or job.wait not in one.loop_of:
            return period
        if job.offer.kind == "event":
            # An event is kept until a thread waits for it.
            is_waited_for = one.thread.begins_at_once and one.is_prompt(job.offer.channel, writes=False)
            return 0 if is_waited_for else period
        # After waiting within a job it may arrive late at the delay.
        return period if job.offer.kind == "delay" and (job.path.meets or job.path.delays) else 0

    def _propagate_from(self, one: Behaviour, refusals: list[Refusal]) -> None:
        """Add the jobs that the communications of a thread begin in others, and those that these begin in turn."""
        pending: list[_Trigger] = []
        for job in one.jobs:
            period = self._period(one, job)
            if period:
                is_sample = job.offer is not None and job.offer.kind == "sample"
                # A thread without samples may have been kept from communicating for any length of time.
                jitter = 0 if is_sample or period == ONCE else self._jitter(one, job, period) + period
                pending += [
                    _Trigger(one.number, channel, writes, period, count, 0 if is_sample else 1, jitter)
                    for channel, writes, count in triggered_by(one, job)
                ]
        while pending:
            trigger = pending.pop()
            known = (trigger.thread, trigger.channel, trigger.writes, trigger.period, trigger.count)
            if known in self._activated:
                continue
            if trigger.count > LARGEST_NUMBER_OF_COMMUNICATIONS:
                refusals.append(_unbounded_triggering(one, trigger))
                return
            self._activated.add(known)
            for other in self.taking_part(trigger.channel, writes=not trigger.writes):
                if other.number != trigger.thread:
                    pending += self._begin(one, trigger, other)

    def _begin(self, one: Behaviour, trigger: _Trigger, other: Behaviour) -> Iterator[_Trigger]:
        """Add the jobs that communications begin in another thread; returns what these trigger."""
        jobs = other.jobs_begun_by(trigger.channel, writes=not trigger.writes)
        jitter = self._jitter_of_triggered(trigger, other)
        work = max((job.path.work for job in jobs), default=0)
        suspension = max((job.path.delay_time for job in jobs if job.follows_samples), default=0)
        meets = any(job.path.meets and job.follows_samples for job in jobs)
        if work or suspension or meets:
            step = max(job.path.step for job in jobs)
            # Each thread that communicates there begins the work again.
            self.by_thread[other.number].append(
                Demand(
                    other.number, other.level, trigger.period, trigger.count * work, step,
                    trigger.count * max(job.path.delays for job in jobs),
                    one.number, True, f"{trigger.channel} of {trigger.thread}", jitter, trigger.count * suspension,
                    trigger.count * meets,
                )
            )  # fmt: skip
        for job in jobs:
            for met, side, times in triggered_by(other, job):
                yield _Trigger(other.number, met, side, trigger.period, trigger.count * times, trigger.hops + 1, jitter)

    def _jitter_of_triggered(self, trigger: _Trigger, other: Behaviour) -> int:
        """The release jitter of jobs that communications begin in another thread."""
        if trigger.period == ONCE or other.is_prompt(trigger.channel, writes=not trigger.writes):
            return trigger.jitter
        capacity = self._capacities.get(trigger.channel, 0)
        if trigger.hops == 0:
            # A thread with samples waits until its value is taken, or the value is kept in the channel.
            return trigger.period * (capacity + 1) if capacity else 0
        return trigger.period * (len(self.behaviours) + sum(self._capacities.values()) + 2)

    def taking_part(self, channel: str, *, writes: bool) -> list[Behaviour]:
        """The threads that may communicate on that side of a channel."""
        return list(self._sides.get((channel, writes), {}).values())

    def activators(self, channel: str, *, writes: bool) -> set[int]:
        """The threads that do communicate on that side of a channel."""
        return {number for number, other, side, _, _ in self._activated if (other, side) == (channel, writes)}


def _unbounded_triggering(one: Behaviour, trigger: _Trigger) -> Refusal:
    """Refuse communications that seem to trigger ever more of themselves."""
    name = trigger.channel.rpartition(".")[2]
    return Refusal(
        one.thread.path,
        f"how often it makes others communicate on `{name}` in a period cannot be bounded",
        one.thread.places[one.thread.entry].span,
        f"read or write `{name}` once in each round of the loops that do",
    )


def _unknown_rate(one: Behaviour, job: Job) -> Refusal:
    """Refuse work that may be released at an unknown rate."""
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


def triggered_by(one: Behaviour, job: Job) -> Iterator[tuple[str, bool, int]]:
    """The communications that a job may begin: channel, side, and how often.

    Includes those that a thread without samples waits for afterwards.
    """
    yield from job.path.communications()
    for stop in job.path.stops:
        if not one.thread.places[stop].is_idle:
            for offer in one.thread.places[stop].offers:
                yield offer.channel, offer.writes, 1


def merged(alternatives: Iterable[Sequence[Demand]]) -> list[Demand]:
    """The largest demands of several alternatives, of which one is active at a time.

    Jobs for samples of one period in a thread exclude each other too, because it runs in one mode at a time.
    """
    most: dict[tuple[int, int, int, str], Demand] = {}
    for demands in alternatives:
        for part in demands:
            key = (part.level, part.period, part.thread, part.cause)
            known = most.get(key)
            most[key] = part if known is None else _larger(known, part)
    return list(most.values())


def _larger(one: Demand, other: Demand) -> Demand:
    shared_with = one.shared_with | other.shared_with | ({other.thread} if other.thread != one.thread else set())
    return replaced(
        one, origin=one.origin if one.origin == other.origin or not one.is_triggered else -1, shared_with=shared_with,
        work=max(one.work, other.work), step=max(one.step, other.step), delays=max(one.delays, other.delays),
        jitter=max(one.jitter, other.jitter), suspension=max(one.suspension, other.suspension),
        meets=max(one.meets, other.meets),
    )  # fmt: skip


def largest_of_groups(groups: Iterable[list[Demand]]) -> list[Demand]:
    """The largest demands of several groups of threads that are never active together.

    At each level and period the demands of a group are compared in order, from the largest on.
    """
    slots: dict[tuple[int, int, bool], list[Demand]] = {}
    for group in groups:
        own: dict[tuple[int, int, bool], list[Demand]] = {}
        for part in group:
            own.setdefault((part.level, part.period, part.is_triggered), []).append(part)
        for key, parts in own.items():
            known = slots.setdefault(key, [])
            for k, part in enumerate(sorted(parts, key=lambda part: -part.work)):
                if k < len(known):
                    known[k] = _larger(known[k], part)
                else:
                    known.append(part)
    return [part for parts in slots.values() for part in parts]
