"""A simulation of one hyperperiod: every job takes its longest time, and all periods begin together, as in a program.

It shows the schedule but does not bound it: without preemption a job that ends early may make another one late, which
the response-time analysis takes into account and this simulation does not.
"""

from __future__ import annotations

import heapq
from collections.abc import Sequence
from math import lcm

from cspdiag.analyses.timing.task import Task
from cspdiag.base.record import record

LARGEST_NUMBER_OF_JOBS = 20_000


@record
class Slice:
    """A step of a job: the index of its task, the release of the job, and from when to when the step ran, in
    nanoseconds.
    """

    task: int
    release: int
    start: int
    end: int
    is_last: bool


@record
class Schedule:
    """What ran in ``length`` nanoseconds; ``is_whole`` is False if the hyperperiod is longer, or has too many jobs."""

    hyperperiod: int
    length: int
    slices: tuple[Slice, ...]
    is_whole: bool

    def longest_response(self, task: int) -> int:
        """The longest observed time from a release of the task to the end of that job; 0 if none ended."""
        return max((part.end - part.release for part in self.slices if part.task == task and part.is_last), default=0)


def hyperperiod(tasks: Sequence[Task]) -> int:
    """The time after which the schedule repeats."""
    return lcm(*(task.period for task in tasks)) if tasks else 0


def simulate(tasks: Sequence[Task], *, limit: int | None = None, hyperperiods: int = 1, first: int = 0) -> Schedule:
    """Run the tasks from a common tick over some hyperperiods, or up to ``limit`` nanoseconds.

    ``first`` is the number of the first job of each task: 1 when a program starts, because its first samples come after
    a period.
    """
    whole = hyperperiod(tasks)
    length = hyperperiods * whole if limit is None else min(hyperperiods * whole, limit)
    jobs_in = sum(length // task.period for task in tasks)
    if jobs_in > LARGEST_NUMBER_OF_JOBS:
        length = max(1, length * LARGEST_NUMBER_OF_JOBS // jobs_in)
    releases = sorted(
        (k * task.period, number)
        for number, task in enumerate(tasks)
        if task.work
        for k in range(first, -(-length // task.period))
    )
    slices: list[Slice] = []
    ready: list[tuple[int, int, int, int, int]] = []
    now = position = order = 0
    while position < len(releases) or ready:
        if not ready:
            now = max(now, releases[position][0])
        while position < len(releases) and releases[position][0] <= now:
            release, number = releases[position]
            heapq.heappush(ready, (tasks[number].priority, order, number, release, tasks[number].work))
            position, order = position + 1, order + 1
        priority, place, number, release, remaining = heapq.heappop(ready)
        run = min(remaining, tasks[number].step)
        slices.append(Slice(number, release, now, now + run, run == remaining))
        now += run
        if run < remaining:
            heapq.heappush(ready, (priority, place, number, release, remaining - run))
    return Schedule(whole, length, tuple(slices), length == hyperperiods * whole)
