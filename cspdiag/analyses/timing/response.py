"""Worst response times under fixed priorities with steps that nothing preempts.

Joseph and Pandya (1986) with jitter, blocking and arbitrary deadlines (Audsley and others, 1993; Tindell, 1994), the last step that cannot be
preempted (George, Rivierre and Spuri, 1996; Bril, Lukkien and Verhaegh, 2009), and first come, first served within a level (George and others, section
on FIFO). Time is discrete: who blocks has started at least one unit before.

The response is measured from the nominal release, k·period, to the end of the last step.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from cspdiag.analyses.timing.task import Task

LARGEST_NUMBER_OF_JOBS = 100_000
"""A busy period with more jobs of one task is given up."""


@dataclass(frozen=True, slots=True)
class Response:
    """The bound for one task: ``worst`` response, latest ``start`` of a job's last step, both from the nominal release; ``blocking`` by
    less urgent steps. ``worst`` and ``start`` are None where the level is overloaded, so that there is no bound.
    """

    worst: int | None
    start: int | None
    blocking: int


_Interference = tuple[tuple[int, int, int], ...]
"""Of each interfering task: period, work, jitter."""


def response_times(tasks: Sequence[Task]) -> list[Response]:
    """The bound for every task, in the order given."""
    order = sorted(range(len(tasks)), key=lambda k: tasks[k].priority)
    by_level: dict[int, list[int]] = {}
    for k in order:
        by_level.setdefault(tasks[k].priority, []).append(k)
    longest_below = 0
    below: dict[int, int] = {}
    for level in reversed(by_level):
        below[level] = longest_below
        longest_below = max(longest_below, *(tasks[k].step for k in by_level[level]))
    found: dict[int, Response] = {}
    above: list[Task] = []
    for level, members in by_level.items():
        for k in members:
            same = [tasks[other] for other in members if other != k]
            found[k] = _response(tasks[k], above, same, max(0, below[level] - 1))
        above += [tasks[k] for k in members]
    return [found[k] for k in range(len(tasks))]


def response_time(task: Task, others: Sequence[Task]) -> Response:
    """The bound for one task beside others."""
    blocking = max((other.step - 1 for other in others if other.priority > task.priority), default=0)
    above = [other for other in others if other.priority < task.priority]
    same = [other for other in others if other.priority == task.priority]
    return _response(task, above, same, max(0, blocking))


def _response(task: Task, above: Sequence[Task], same: Sequence[Task], blocking: int) -> Response:
    blocking *= 1 + task.suspensions
    busy = _busy_period((*above, *same, task), blocking)
    if busy is None or sum(Fraction(other.work, other.period) for other in above) >= 1:
        return Response(None, None, blocking)
    if not task.has_one_step:
        # Others of the level may come between its steps, as those above do.
        above, same = (*above, *same), ()
    interference = tuple((other.period, other.work, other.jitter) for other in above if other.work)
    worst = latest = 0
    for arrival in _arrivals(task, same, busy):
        before = blocking + arrival // task.period * task.work + task.work - task.final
        for other in same:
            before += ((arrival + other.jitter) // other.period + 1) * other.work
        start = max(_least_start(before, interference, blocking), arrival)
        worst = max(worst, start + task.final - arrival)
        latest = max(latest, start - arrival)
    return Response(worst + task.jitter, latest + task.jitter, blocking)


def _arrivals(task: Task, same: Sequence[Task], busy: int) -> list[int]:
    """The arrivals in a busy period, from its beginning, after which a job may wait longest."""
    instants = set(range(0, max(busy, 1), task.period))
    for other in same:
        if other.work:
            instants.update(range(-other.jitter % other.period, busy, other.period))
    return sorted(instants)


def _busy_period(tasks: Sequence[Task], blocking: int) -> int | None:
    """The longest time for which a level stays busy; None where it has no bound."""
    demands = tuple((task.period, task.work, task.jitter) for task in tasks if task.work)
    if not demands:
        return blocking
    load = sum(work / period for period, work, _ in demands)
    if load > 1 - 1e-9:
        exact = sum((Fraction(work, period) for period, work, _ in demands), Fraction())
        if exact > 1 or (exact == 1 and (blocking or any(jitter for _, _, jitter in demands))):
            return None
    shortest = min(period for period, _, _ in demands)
    length = max(_lower_bound(blocking, demands, load), blocking + sum(work for _, work, _ in demands))
    while True:
        longer = blocking + sum([-(-(length + jitter) // period) * work for period, work, jitter in demands])
        if longer <= length:
            return length
        length = longer
        if length // shortest > LARGEST_NUMBER_OF_JOBS:
            return None


def _least_start(before: int, interference: _Interference, blocking: int) -> int:
    """The least s with s = before + the work above that arrives up to s."""
    load = sum([work / period for period, work, _ in interference])
    start = _lower_bound(before, interference, load)
    while True:
        later = before + sum([((start + jitter) // period + 1) * work for period, work, jitter in interference])
        if later <= start:
            return start
        start = later


def _lower_bound(before: int, demands: _Interference, load: float) -> int:
    """Not more than the least fixed point: each task demands at least its share of the time. The margin makes up for rounding."""
    if load > 0.999:
        return before
    certain = before + sum([work * jitter / period for period, work, jitter in demands])
    return max(before, int(certain / (1 - load) * (1 - 1e-9)) - 1)
