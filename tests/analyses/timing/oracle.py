"""A processor simulated unit by unit, starting at the worst instants for one task: the analysis of response times must
agree with it.

It shares nothing with the analysis: there are no fixed points here, only queues.
"""

from __future__ import annotations

from cspdiag.analyses.timing.task import Task


class _Job:
    def __init__(self, task: Task, arrival: int, order: int) -> None:
        self.task = task
        self.arrival = arrival
        self.order = order
        self.remaining = task.work

    def next_step(self) -> int:
        """How long the job runs now without being preempted."""
        return min(self.remaining, self.task.step)


def worst_response(task: Task, others: list[Task], horizon: int) -> int:
    """The longest response of a job of ``task`` up to ``horizon``, from its nominal release, over all its phases."""
    same = any(other.priority == task.priority for other in others)
    phases = range(task.period) if same else range(1)
    return max(_longest(task, others, phase, horizon) for phase in phases) + task.jitter


def _longest(task: Task, others: list[Task], phase: int, horizon: int) -> int:
    """All other tasks arrive together as late, and then as often, as they can; the longest step with a lower priority
    began one unit before.
    """
    jobs: list[tuple[int, int, Task]] = []
    for other in others:
        if other.priority <= task.priority:
            arrivals = (max(0, k * other.period - other.jitter) for k in range(horizon // other.period + 2))
            jobs += [(arrival, 0, other) for arrival in arrivals]
    # Of the jobs of one level that arrive at one instant, those of the task are served last.
    jobs += [(phase + k * task.period, 1, task) for k in range((horizon - phase) // task.period + 1)]
    jobs.sort(key=lambda job: job[:2])
    below = [other.step for other in others if other.priority > task.priority]
    now = max(0, max(below, default=0) - 1)
    ready: list[_Job] = []
    longest = position = 0
    while position < len(jobs) or ready:
        while position < len(jobs) and jobs[position][0] <= now:
            ready.append(_Job(jobs[position][2], jobs[position][0], position))
            position += 1
        if not ready:
            break  # The busy period is over; what comes later is no worse.
        job = min(ready, key=lambda job: (job.task.priority, job.order))
        length = job.next_step()
        now += length
        job.remaining -= length
        if job.remaining == 0:
            ready.remove(job)
            if job.task is task:
                longest = max(longest, now - job.arrival)
    return longest
