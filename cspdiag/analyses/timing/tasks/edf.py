"""Whether earliest deadline first would meet the deadlines of the same tasks, by their demand bound.

Jeffay, Stanat and Martel (1991) for steps without preemption; the search is the quick processor-demand analysis of
Zhang and Burns (2009).
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from cspdiag.analyses.timing.task import Task


def demand_bound(tasks: Sequence[Task], interval: int) -> int:
    """The demand bound of an interval: the work of all jobs that arrive and have their deadlines in it."""
    total = 0
    for task in tasks:
        jobs = (interval + task.jitter - task.deadline) // task.period + 1
        total += max(0, jobs) * task.work
    return total


def meets_deadlines(tasks: Sequence[Task]) -> bool:
    """Whether earliest deadline first meets every deadline; deadlines are relative to the nominal release."""
    load = sum((Fraction(task.work, task.period) for task in tasks), Fraction())
    if load > 1 or any(task.deadline <= task.jitter for task in tasks):
        return False
    if not tasks:
        return True
    horizon = _horizon(tasks, load)
    shortest = min(task.deadline - task.jitter for task in tasks)
    interval = _deadline_before(tasks, horizon + 1)
    while interval is not None and interval >= shortest:
        demanded = demand_bound(tasks, interval) + _blocking(tasks, interval)
        if demanded > interval:
            return False
        # Shorter intervals have less demand, but more tasks may block them; there the next deadline is checked.
        interval = _deadline_before(
            tasks, interval if demanded == interval else max(demanded + 1, _change(tasks, interval))
        )
    return True


def _blocking(tasks: Sequence[Task], interval: int) -> int:
    return max((max(0, task.step - 1) for task in tasks if task.deadline - task.jitter > interval), default=0)


def _change(tasks: Sequence[Task], interval: int) -> int:
    """The next shorter interval at which another task begins to block, plus one; 0 if there is none."""
    return max((d for task in tasks if (d := task.deadline - task.jitter) <= interval), default=0)


def _horizon(tasks: Sequence[Task], load: Fraction) -> int:
    """The longest interval to check: no longer than the longest busy period (Spuri, 1996)."""
    latest = max(task.deadline for task in tasks)
    if load < 1:
        surplus = sum(
            (max(0, task.period + task.jitter - task.deadline) * Fraction(task.work, task.period) for task in tasks),
            Fraction(),
        )
        blocking = max(task.step for task in tasks)
        return max(latest, int((surplus + blocking) / (1 - load)) + 1)
    from math import lcm

    return lcm(*(task.period for task in tasks)) + latest


def _deadline_before(tasks: Sequence[Task], limit: int) -> int | None:
    """The latest absolute deadline before an instant, with all arrivals as early as possible."""
    latest: int | None = None
    for task in tasks:
        first = task.deadline - task.jitter
        if first < limit:
            last = first + (limit - 1 - first) // task.period * task.period
            latest = last if latest is None else max(latest, last)
    return latest
