"""The task model of the timing analysis: recurring work on one processor, which switches only between steps."""

from __future__ import annotations

from cspdiag.base.record import record

ONCE = 2**60
"""The period, in nanoseconds, of what happens at most once: longer than any program runs."""


def last_in_time(period: int) -> int:
    """The deadline of a sample, from its tick on: the last instant before the next sample comes.

    What happens in the instant of a tick happens after the tick, which takes the sample and hands outputs over.
    """
    return period - 1


@record
class Task:
    """Recurring work; all times are integer nanoseconds (any integer unit does).

    A job is released at most once every ``period``, nominally at k·period, and arrives up to ``jitter`` later. Its
    worst-case execution time is ``work``, in steps: a step runs without preemption until the process waits. ``step`` is
    the longest step, ``final`` a lower bound of the last one; for a job of one step both are equal to ``work``.
    ``deadline`` is the latest end that is in time, from the nominal release on. ``priority`` orders levels, the
    smallest being the most urgent; within a level jobs are served first come, first served. ``suspensions`` is the
    number of times that a job lets time pass within ``work`` without using the processor.
    """

    name: str
    period: int
    work: int
    deadline: int
    priority: int
    jitter: int = 0
    step: int = -1
    final: int = -1
    suspensions: int = 0

    def __post_init__(self) -> None:
        if self.period <= 0 or self.work < 0 or self.jitter < 0:
            raise ValueError(f"{self.name}: the period must be positive, work and jitter not negative")
        if self.step < 0:
            object.__setattr__(self, "step", self.work)
        if self.final < 0:
            object.__setattr__(self, "final", self.work if self.step == self.work else 0)

    @property
    def utilization(self) -> float:
        """The share of the processor that the task needs."""
        return self.work / self.period

    @property
    def has_one_step(self) -> bool:
        """Whether a job runs to its end once it has started."""
        return self.final == self.work
