"""When a sampled port communicates, in nanoseconds from the start of the program."""

from __future__ import annotations

from cspdiag.base.record import record
from cspdiag.model.constants.durations import duration


@record
class Sampling:
    """The sample instants of a port, its ticks: later than 0, and ``offset`` after a whole multiple of ``period``.

    ``offset`` is not negative and shorter than the period, so that equal samplings have equal ticks.
    """

    period: int
    offset: int = 0

    def is_tick(self, instant: int) -> bool:
        """Whether a sample is taken at an instant later than 0."""
        return instant % self.period == self.offset

    def latest_tick(self, instant: int) -> int:
        """The last tick up to and including ``instant``; before the first tick, an instant up to 0."""
        return instant - (instant - self.offset) % self.period

    def next_tick(self, instant: int) -> int:
        """The first tick later than an instant."""
        return self.latest_tick(instant) + self.period

    def __str__(self) -> str:
        """As it is written after ``@``: ``10 ms``, ``10 ms offset 2 ms``."""
        return f"{duration(self.period)} offset {duration(self.offset)}" if self.offset else duration(self.period)

    @property
    def every(self) -> str:
        """``every 10 ms``, ``every 10 ms with an offset of 2 ms``."""
        behind = f" with an offset of {duration(self.offset)}" if self.offset else ""
        return f"every {duration(self.period)}{behind}"
