"""The time to compute the response times of 100 tasks, in milliseconds: one level per task, or five levels in which
tasks are served first come, first served.
"""

from __future__ import annotations

import random
import time

from timing import BATCHES, report, requested_benchmark, size_of

from cspdiag.analyses.timing.task import Task
from cspdiag.analyses.timing.tasks.response import response_times

PERIODS = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
"""In milliseconds."""

LOAD = 0.9

source = random.Random(1)
number = size_of(requested_benchmark())
levels = 5 if "levels" in requested_benchmark() else number
tasks = []
for name in range(number):
    period = source.choice(PERIODS) * 1_000_000
    work = int(period * LOAD / number * source.uniform(0.5, 1.5))
    tasks.append(Task(str(name), period, work, period, 0))
tasks.sort(key=lambda task: task.period)
ranked = [
    Task(task.name, task.period, task.work, task.deadline, rank * levels // number) for rank, task in enumerate(tasks)
]

response_times(ranked)
for _ in range(BATCHES):
    began = time.perf_counter()
    assert all(response.worst is not None for response in response_times(ranked))
    report((time.perf_counter() - began) * 1e3)
