"""When a sampled port communicates, in nanoseconds from the start of the program."""

from __future__ import annotations

from cspdiag.base.record import record
from cspdiag.model.constants.durations import duration


@record
class Sampling:
    """The sample instants of a port, its ticks: the whole multiples of ``period``. Equal samplings have equal ticks."""

    period: int

    def is_tick(self, instant: int) -> bool:
        """Whether a sample is taken at an instant."""
        return instant % self.period == 0

    def latest_tick(self, instant: int) -> int:
        """The last tick up to an instant, which may be one itself."""
        return instant - instant % self.period

    def next_tick(self, instant: int) -> int:
        """The first tick later than an instant."""
        return self.latest_tick(instant) + self.period

    def __str__(self) -> str:
        """As it is written after ``@``: ``10 ms``."""
        return duration(self.period)

    @property
    def every(self) -> str:
        """``every 10 ms``."""
        return f"every {duration(self.period)}"
