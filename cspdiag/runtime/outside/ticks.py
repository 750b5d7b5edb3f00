"""When a sampled port communicates."""

from __future__ import annotations

from typing import NamedTuple


class Ticks(NamedTuple):
    """The instants of a sampled port, in nanoseconds from the start: later than 0, and ``offset`` after a multiple of
    the period, which is longer.
    """

    period: int
    offset: int = 0

    def at(self, instant: int) -> bool:
        """Whether one is at an instant later than 0."""
        return instant % self.period == self.offset

    def after(self, instant: int) -> int:
        """The first one later than an instant."""
        return instant + self.period - (instant - self.offset) % self.period
