"""Durations: integer nanoseconds, written as ``5 * ms``."""

from __future__ import annotations

import re
from typing import Final

ns: Final = 1
us: Final = 1_000
ms: Final = 1_000_000
s: Final = 1_000_000_000

_UNITS = {"ns": ns, "us": us, "ms": ms, "s": s, "min": 60 * s}
_FREQUENCIES = {"Hz": 1, "kHz": 1_000, "MHz": 1_000_000}

END_OF_TIME: Final = 9_223_372_036 * s
"""The last instant of any run in virtual time, after 292 years: later ones are outside of ``time``."""


def seconds(duration: int) -> float:
    """A duration in nanoseconds as seconds."""
    return duration / 1e9


def nanoseconds(duration: float) -> int:
    """A duration in seconds as whole nanoseconds, halves away from zero."""
    scaled = duration * 1e9
    return int(scaled + 0.5) if scaled >= 0 else -int(0.5 - scaled)


def duration_of(text: str) -> int:
    """``20s``, ``1.5 ms`` or the period of ``100 Hz`` in nanoseconds, exact, halves away from zero as in the language.

    Raises ValueError for anything else.
    """
    from decimal import ROUND_HALF_UP, Context, Decimal

    match = re.fullmatch(r"((?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d{1,4})?)\s*([a-zA-Z]+)", text.strip(), re.ASCII)
    if match is None or match[2] not in {*_UNITS, *_FREQUENCIES}:
        raise ValueError(f"{text!r} is not a duration such as 20s or 500ms (there are {', '.join(_UNITS)})")
    # As many digits as it takes for no rounding but the last.
    exact = Context(prec=len(match[1]) + 40, rounding=ROUND_HALF_UP)
    number = Decimal(match[1])
    if match[2] in _UNITS:
        duration = exact.multiply(number, _UNITS[match[2]])
    elif not number:
        raise ValueError(f"{text!r} has no period")
    else:
        duration = exact.divide(s, exact.multiply(number, _FREQUENCIES[match[2]]))
    if duration.adjusted() > 18 or duration > 2**63 - 1:
        raise ValueError(f"{text!r} is longer than 292 years")
    return int(duration.to_integral_value(ROUND_HALF_UP))


def shown(duration: int) -> str:
    """A duration for people: ``1.5 ms``."""
    for unit, name in ((s, "s"), (ms, "ms"), (us, "us")):
        if abs(duration) >= unit:
            return f"{duration / unit:.9g} {name}"
    return f"{duration} ns" if duration else "0 s"
