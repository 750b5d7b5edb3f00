"""When a sampled port communicates."""

from __future__ import annotations

from typing import NamedTuple


class Ticks(NamedTuple):
    """The instants of a sampled port, in nanoseconds from the start: later than 0, and ``offset`` after a multiple of
    the period. The offset is shorter than the period.
    """

    period: int
    offset: int = 0

    def at(self, instant: int) -> bool:
        """Whether there is a tick at ``instant``, which is later than 0."""
        return instant % self.period == self.offset

    def after(self, instant: int) -> int:
        """The first tick later than ``instant``."""
        return instant + self.period - (instant - self.offset) % self.period
