"""How late the ticks of a period were in a real-time run."""

from __future__ import annotations

from collections import Counter
from math import ceil, sqrt
from typing import Final

from ..kernel.durations import shown

_BITS: Final = 4
"""The digits, in binary, to which each lateness is kept for `Jitter.below`: an error of at most 1/16."""


class Jitter:
    """The lateness of ticks, in nanoseconds. Memory does not grow with the length of a run."""

    def __init__(self) -> None:
        self.count = 0
        self.worst = 0
        self._sum = 0
        self._squares = 0
        self._classes: Counter[int] = Counter()
        """How often, by the greatest lateness of each class."""

    def add(self, late: int) -> None:
        """One tick."""
        self.count += 1
        self.worst = max(self.worst, late)
        self._sum += late
        self._squares += late * late
        scale = max(0, late.bit_length() - _BITS - 1)
        self._classes[((late >> scale) + 1) << scale] += 1

    @property
    def mean(self) -> float:
        """Mean lateness."""
        return self._sum / self.count if self.count else 0.0

    @property
    def deviation(self) -> float:
        """Standard deviation of the lateness."""
        return sqrt(max(0.0, self._squares / self.count - self.mean**2)) if self.count else 0.0

    def below(self, part: float) -> int:
        """The lateness that ``part`` of the ticks did not exceed (0.99 of them, say): an upper bound, at most 1/16 too
        high.
        """
        remaining = ceil(part * self.count)
        for limit, occurrences in sorted(self._classes.items()):
            remaining -= occurrences
            if remaining <= 0:
                return min(limit, self.worst)
        return self.worst

    def __str__(self) -> str:
        return (
            f"mean {shown(round(self.mean))}, deviation {shown(round(self.deviation))}, "
            f"99 % within {shown(self.below(0.99))}, worst {shown(self.worst)}"
        )
