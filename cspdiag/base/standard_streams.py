"""The standard streams of a command, whatever the program that it runs sets or closes instead.

Generated packages carry this module in their runtime.
"""

from __future__ import annotations

import os
import sys
from typing import TextIO

_kept: dict[str, TextIO] = {}


def keep() -> None:
    """Fix the present streams as the standard ones; called by a command that is its own process."""
    _kept.update(stdout=sys.stdout, stderr=sys.stderr)


def standard_output() -> TextIO:
    """That of the command, or the present one."""
    return _stream("stdout", 1)


def standard_error() -> TextIO:
    """That of the command, or the present one."""
    return _stream("stderr", 2)


def _stream(name: str, number: int) -> TextIO:
    stream: TextIO | None = _kept.get(name) or getattr(sys, name)
    if stream is not None and not (_kept and stream.closed):
        return stream
    stream = os.fdopen(number, "w", encoding="utf-8", errors="backslashreplace", closefd=False)
    if _kept:
        _kept[name] = stream
    return stream
