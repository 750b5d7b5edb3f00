"""What the timing analyses reason about: recurring work on one processor that is given up only between steps."""

from __future__ import annotations

from cspdiag.base.record import record

ONCE = 2**60
"""The period of what happens at most once, in nanoseconds: longer than any program runs."""


@record
class Task:
    """Recurring work; all times are integer nanoseconds (any integer unit does).

    A job is released at most every ``period``, nominally at k·period, and arrives up to ``jitter`` later. It executes
    up to ``work``, in steps: a step runs until the process waits, and nothing preempts it. ``step`` is the longest of
    them, ``final`` a lower bound of the last one; a job of one step has both equal to ``work``. ``priority`` orders
    levels, the smallest being the most urgent; within a level the scheduler serves first come, first served.
    ``suspensions`` counts how often a job lets time pass within ``work`` without using the processor.
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
        """Whether a job, once it has started, runs to its end."""
        return self.final == self.work
