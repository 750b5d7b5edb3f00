"""Enums and structs of the program."""

from __future__ import annotations

from typing import NamedTuple


class ServoGains(NamedTuple):
    """The struct ServoGains."""

    kp: float
    tauD: int
    beta: float
    tauI: int
    friction: float
    tolerance: float
