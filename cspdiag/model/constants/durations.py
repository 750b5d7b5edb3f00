"""Durations as text."""

from __future__ import annotations


def duration(nanoseconds: int) -> str:
    """A duration in the largest unit of which it is an integer multiple: ``2 ms``."""
    for unit, size in (("s", 1_000_000_000), ("ms", 1_000_000), ("us", 1_000)):
        if nanoseconds % size == 0:
            return f"{nanoseconds // size} {unit}"
    return f"{nanoseconds} ns"


def rounded(nanoseconds: float) -> str:
    """A duration with four digits: ``1.25 ms``."""
    for unit, size in (("s", 1e9), ("ms", 1e6), ("us", 1e3), ("ns", 1.0)):
        written = f"{nanoseconds / size:.4g}"
        # A duration that rounds to the next unit is written in that unit.
        if abs(float(written)) >= 1:
            return f"{written} {unit}"
    return f"{nanoseconds:.4g} ns" if nanoseconds else "0"
