"""What people see: diagnostics on standard error, in colours where that is wanted."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, TextIO

from cspdiag.diagnostics.snippet import printable

if TYPE_CHECKING:
    from cspdiag.diagnostics.diagnostic import Diagnostic


def wants_colour(choice: str, stream: TextIO) -> bool:
    """Whether to colour what goes to ``stream``: as chosen, or on a terminal unless NO_COLOR is set."""
    if choice != "auto":
        return choice == "always"
    return not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb" and stream.isatty()


def show_diagnostics(diagnostics: Sequence[Diagnostic], color: str) -> None:
    """Write diagnostics with their source to standard error."""
    if diagnostics:
        from cspdiag.diagnostics.render_text import render

        put(render(diagnostics, colour=wants_colour(color, sys.stderr)))


def say(text: str) -> None:
    """Write a line, or several, to standard error: what is in them from outside, such as names of files, steers no terminal."""
    put(f"{printable(text)}\n")


def put(text: str) -> None:
    """Write to standard error as it is. Where that is gone, as when its terminal was closed, nobody is told, and the command goes on."""
    try:
        sys.stderr.write(text)
        sys.stderr.flush()
    except OSError:
        # The interpreter would try once more when it ends.
        with suppress(OSError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stderr.fileno())
