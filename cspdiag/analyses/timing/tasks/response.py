"""Worst-case response times under fixed priorities with steps that are not preempted.

Joseph and Pandya (1986) with jitter, blocking and arbitrary deadlines (Audsley and others, 1993; Tindell, 1994), a last
step that is not preempted (George, Rivierre and Spuri, 1996; Bril, Lukkien and Verhaegh, 2009), and first come, first
served within a level (George and others, section on FIFO). Time is discrete: a blocking step has started at least one
unit before.

The response time is measured from the nominal release, k·period, to the end of the last step.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from fractions import Fraction
from itertools import accumulate
from operator import itemgetter

from cspdiag.analyses.timing.task import Task
from cspdiag.base.record import record

LARGEST_NUMBER_OF_JOBS = 100_000
"""A busy period with more jobs of one task is not analysed."""


@record
class Response:
    """The bound for one task: its ``worst`` response time, the latest ``start`` of a job's last step, both from the
    nominal release, and ``blocking`` by less urgent steps.

    ``worst`` and ``start`` are None where the level is overloaded, so there is no bound.
    """

    worst: int | None
    start: int | None
    blocking: int


_Interference = tuple[tuple[int, int, int], ...]
"""Period, work and jitter of each interfering task."""


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
        queue = _Queue(above, [tasks[k] for k in members], max(0, below[level] - 1))
        for k in members:
            found[k] = queue.response(tasks[k])
        above += [tasks[k] for k in members]
    return [found[k] for k in range(len(tasks))]


def response_time(task: Task, others: Sequence[Task]) -> Response:
    """The bound for one task in competition with others."""
    blocking = max((other.step - 1 for other in others if other.priority > task.priority), default=0)
    above = [other for other in others if other.priority < task.priority]
    same = [other for other in others if other.priority == task.priority]
    return _Queue(above, [task, *same], max(0, blocking)).response(task)


class _Queue:
    """The tasks of one level, which are served first come, first served, below more urgent ones."""

    def __init__(self, above: Sequence[Task], members: Sequence[Task], blocking: int) -> None:
        self.above = above
        self.members = members
        self.blocking = blocking
        self.is_full = _load(above) >= 1
        self._busy: dict[int, int | None] = {}
        self._longest_queue: int | None = None
        self._arrivals: list[tuple[int, int]] | None = None

    def response(self, task: Task) -> Response:
        """The bound for one of the members."""
        blocking = self.blocking * (1 + task.suspensions)
        if blocking not in self._busy:
            self._busy[blocking] = None if self.is_full else _busy_period((*self.above, *self.members), blocking)
        busy = self._busy[blocking]
        if busy is None:
            return Response(None, None, blocking)
        interference = _interference(self.above)
        if task.has_one_step and len(self.members) > 1:
            jobs = self._work(busy, task)
            if task.jitter:
                jobs = [(arrival, work + _own_correction(task, arrival)) for arrival, work in jobs]
        else:
            # Other tasks of the level may run between its steps, like the more urgent ones.
            interference += _interference([other for other in self.members if other is not task])
            jobs = [(k * task.period, (k + 1) * task.work) for k in range(-(-max(busy, 1) // task.period))]
        if task.has_one_step and not interference and not task.jitter and len(self.members) > 1:
            # All tasks of the most urgent level have the same bound.
            if self._longest_queue is None:
                self._longest_queue = max(work - arrival for arrival, work in jobs)
            worst = max(blocking + self._longest_queue, task.final)
            return Response(worst, worst - task.final, blocking)
        worst = latest = 0
        for arrival, work in jobs:
            start = max(_least_start(blocking + work - task.final, interference), arrival)
            worst = max(worst, start + task.final - arrival)
            latest = max(latest, start - arrival)
        return Response(worst + task.jitter, latest + task.jitter, blocking)

    def _work(self, busy: int, task: Task) -> list[tuple[int, int]]:
        """The instants of a busy period at which a job of the task may have the longest response, each with the work
        that has arrived at the level by then.
        """
        if self._arrivals is None:
            arriving: dict[int, int] = {0: 0}
            for other in self.members:
                if other.work:
                    arriving[0] += (other.jitter // other.period + 1) * other.work
                    for instant in range(other.period - other.jitter % other.period, busy, other.period):
                        arriving[instant] = arriving.get(instant, 0) + other.work
            instants = sorted(arriving)
            self._arrivals = list(zip(instants, accumulate(arriving[instant] for instant in instants), strict=True))
        if task.jitter == 0:
            return self._arrivals
        # Its own jobs arrive as close together as possible if they arrive at multiples of its period.
        arrivals = self._arrivals
        own = range(0, busy, task.period)
        return arrivals + [(at, arrivals[bisect_right(arrivals, at, key=itemgetter(0)) - 1][1]) for at in own]


def _own_correction(task: Task, arrival: int) -> int:
    """The correction of a level's work for a job that arrives now: earlier jobs of the same task arrived no later."""
    return (arrival // task.period - (arrival + task.jitter) // task.period) * task.work


def _interference(tasks: Sequence[Task]) -> _Interference:
    return tuple((task.period, task.work, task.jitter) for task in tasks if task.work)


def _load(tasks: Sequence[Task]) -> Fraction | float:
    """The share of the processor that the tasks need; exact if it is close to all of it."""
    load = sum([task.work / task.period for task in tasks])
    return load if load < 1 - 1e-9 else sum((Fraction(task.work, task.period) for task in tasks), Fraction())


def _busy_period(tasks: Sequence[Task], blocking: int) -> int | None:
    """The longest time for which a level stays busy; None if it has no bound."""
    demands = tuple((task.period, task.work, task.jitter) for task in tasks if task.work)
    if not demands:
        return blocking
    exact = _load(tasks)
    load = float(exact)
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


def _least_start(before: int, interference: _Interference) -> int:
    """The least s with s = before + the more urgent work that arrives up to s."""
    if not interference:
        return before
    load = sum([work / period for period, work, _ in interference])
    start = _lower_bound(before, interference, load)
    while True:
        later = before + sum([((start + jitter) // period + 1) * work for period, work, jitter in interference])
        if later <= start:
            return start
        start = later


def _lower_bound(before: int, demands: _Interference, load: float) -> int:
    """At most the least fixed point: each task demands at least its share of the time. The margin covers rounding."""
    if load > 0.999:
        return before
    certain = before + sum([work * jitter / period for period, work, jitter in demands])
    return max(before, int(certain / (1 - load) * (1 - 1e-9)) - 1)
