"""What people see: diagnostics on standard error, in colours where that is wanted."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from typing import TextIO

from cspdiag.diagnostics.diagnostic import Diagnostic
from cspdiag.diagnostics.snippet import printable


def wants_colour(choice: str, stream: TextIO) -> bool:
    """Whether to colour what goes to ``stream``: as chosen, or on a terminal unless NO_COLOR is set."""
    if choice != "auto":
        return choice == "always"
    return not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb" and stream.isatty()


def show_diagnostics(diagnostics: Sequence[Diagnostic], color: str) -> None:
    """Write diagnostics with their source to standard error."""
    if diagnostics:
        from cspdiag.diagnostics.render_text import render

        sys.stderr.write(render(diagnostics, colour=wants_colour(color, sys.stderr)))


def say(text: str) -> None:
    """Write a line, or several, to standard error: what is in them from outside, such as names of files, steers no terminal."""
    sys.stderr.write(f"{printable(text)}\n")
