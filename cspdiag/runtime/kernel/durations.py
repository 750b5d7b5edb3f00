"""Durations: integer nanoseconds, written as ``5 * ms``."""

from __future__ import annotations

import re
from typing import Final

ns: Final = 1
us: Final = 1_000
ms: Final = 1_000_000
s: Final = 1_000_000_000

_UNITS = {"ns": ns, "us": us, "ms": ms, "s": s, "min": 60 * s}

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
    """``20s`` or ``1.5 ms`` in nanoseconds; ValueError for anything else."""
    match = re.fullmatch(r"(\d+(?:\.\d*)?|\.\d+)\s*(ns|us|ms|s|min)", text.strip())
    if match is None:
        raise ValueError(f"{text!r} is not a duration such as 20s or 500ms (there are {', '.join(_UNITS)})")
    duration = float(match[1]) * _UNITS[match[2]]
    if duration > 2**63 - 1:
        raise ValueError(f"{text!r} is longer than 292 years")
    return round(duration)


def shown(duration: int) -> str:
    """A duration for people: ``1.5 ms``."""
    for unit, name in ((s, "s"), (ms, "ms"), (us, "us")):
        if abs(duration) >= unit:
            return f"{duration / unit:.9g} {name}"
    return f"{duration} ns" if duration else "0 s"
