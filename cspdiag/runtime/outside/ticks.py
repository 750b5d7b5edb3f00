"""When a sampled port communicates."""

from __future__ import annotations

from typing import NamedTuple


class Ticks(NamedTuple):
    """The instants of a sampled port, in nanoseconds from the start: the multiples of its period."""

    period: int

    def at(self, instant: int) -> bool:
        """Whether one is at an instant."""
        return instant % self.period == 0

    def after(self, instant: int) -> int:
        """The first one later than an instant."""
        return instant + self.period - instant % self.period
