"""The exact values of number and duration tokens."""

from __future__ import annotations

import math

_NANOSECONDS = {"ns": 1, "us": 1_000, "ms": 1_000_000, "s": 1_000_000_000, "min": 60_000_000_000}
_HERTZ = {"Hz": 1, "kHz": 1_000, "MHz": 1_000_000}
UNITS_OF_DURATIONS = (*_NANOSECONDS, *_HERTZ)
"""What can follow the number of a duration, which may also be given by its frequency."""
_MAX_DIGITS = 64
"""The longest number, in characters; this also limits powers of ten."""
_MAX_EXPONENT = 40


def number_value(digits: str) -> int | float | None:
    """The value: an ``int`` if there are only digits, otherwise a ``float``; None if it is not representable."""
    if digits.isdigit():
        return int(digits) if len(digits) <= _MAX_DIGITS else None
    value = float(digits)
    return value if math.isfinite(value) else None


def nanoseconds(digits: str, unit: str) -> int | None:
    """A duration, or the period of a frequency, rounded to whole nanoseconds.

    None for a frequency of zero, and for a number that is too large or too long.
    """
    mantissa, _, exponent_text = digits.lower().partition("e")
    whole, _, fraction = mantissa.partition(".")
    if len(digits) > _MAX_DIGITS or abs(int(exponent_text or "0")) > _MAX_EXPONENT:
        return None
    exponent = int(exponent_text or "0") - len(fraction)
    numerator = int(f"{whole}{fraction}{'0' * max(exponent, 0)}")
    denominator = int(f"1{'0' * max(-exponent, 0)}")
    if unit in _HERTZ:
        numerator, denominator = 1_000_000_000 * denominator, numerator * _HERTZ[unit]
    else:
        numerator *= _NANOSECONDS[unit]
    if denominator == 0:
        return None
    return (2 * numerator + denominator) // (2 * denominator)
