"""Exceptions of the program."""

from __future__ import annotations

from .runtime import ProcessError


class SensorLost(ProcessError):
    """The exception SensorLost."""


class GivenUp(ProcessError):
    """The exception GivenUp."""
