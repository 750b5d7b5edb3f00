"""Durations as one writes them."""

from __future__ import annotations


def duration(nanoseconds: int) -> str:
    """A duration in the largest unit that leaves a whole number: ``2 ms``."""
    for unit, size in (("s", 1_000_000_000), ("ms", 1_000_000), ("us", 1_000)):
        if nanoseconds % size == 0:
            return f"{nanoseconds // size} {unit}"
    return f"{nanoseconds} ns"
