"""Durations as text."""

from __future__ import annotations


def duration(nanoseconds: int) -> str:
    """A duration in the largest unit of which it is an integer multiple: ``2 ms``."""
    for unit, size in (("s", 1_000_000_000), ("ms", 1_000_000), ("us", 1_000)):
        if nanoseconds % size == 0:
            return f"{nanoseconds // size} {unit}"
    return f"{nanoseconds} ns"


def in_seconds(nanoseconds: int) -> str:
    """A duration in seconds with all its digits, as faults give those that are out of range: ``18000000000.5 s``."""
    whole, rest = divmod(abs(nanoseconds), 1_000_000_000)
    fraction = f".{rest:09}".rstrip("0") if rest else ""
    return f"{'-' if nanoseconds < 0 else ''}{whole}{fraction} s"


def rounded(nanoseconds: float, rounding: str = "ROUND_HALF_EVEN") -> str:
    """A duration with four digits: ``1.25 ms``; ``rounding`` is one of those of ``decimal``."""
    from decimal import Context, Decimal

    value = Decimal(nanoseconds)
    for unit, exponent in (("s", 9), ("ms", 6), ("us", 3), ("ns", 0)):
        found = Context(prec=4, rounding=rounding).plus(value.scaleb(-exponent))
        # A duration that rounds to the next unit is written in that unit.
        if abs(found) >= 1:
            return f"{float(found):.4g} {unit}"
    return f"{float(Context(prec=4, rounding=rounding).plus(value)):.4g} ns" if nanoseconds else "0"
