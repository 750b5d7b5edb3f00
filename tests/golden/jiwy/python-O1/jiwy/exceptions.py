"""Exceptions of the program."""

from __future__ import annotations

from .runtime import ProcessError


class ModeFailed(ProcessError):
    """The exception ModeFailed."""
