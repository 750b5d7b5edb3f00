"""The streams of a command: what is for machines goes to standard output, what is for people to standard error, in
colours where that is wanted.
"""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, TextIO

from cspdiag.base.render.snippet import printable
from cspdiag.base.standard_streams import standard_error, standard_output

if TYPE_CHECKING:
    from cspdiag.base.diagnostic import Diagnostic


def wants_colour(choice: str, stream: TextIO) -> bool:
    """Whether to colour what goes to ``stream``: as chosen, or on a terminal unless NO_COLOR is set."""
    if choice != "auto":
        return choice == "always"
    return not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb" and stream.isatty()


def show_diagnostics(diagnostics: Sequence[Diagnostic], color: str) -> None:
    """Write diagnostics with their source to standard error."""
    if diagnostics:
        from cspdiag.base.render.text import render

        put(render(diagnostics, colour=wants_colour(color, standard_error())))


def write_out(text: str | bytes) -> None:
    """Write to standard output, at once and as it is. Raises OSError, with its name, where that cannot be written."""
    if not text:
        # Even nothing is too much for a full disk.
        return
    try:
        if isinstance(text, str):
            standard_output().write(text)
        else:
            standard_output().buffer.write(text)
        standard_output().flush()
    except OSError as problem:
        reason = "it is closed" if problem.errno == errno.EBADF else problem.strerror
        raise OSError(problem.errno, reason, "standard output") from None


def complete_streams() -> None:
    """Give a process that was started with closed streams (``>&-``) streams again: of standard output and standard
    input one that refuses every call, so that its user reports the error.

    Otherwise the next file that is opened would take their place, and output would go there.
    """
    for number, access in enumerate((os.O_WRONLY, os.O_RDONLY, os.O_WRONLY)):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, access)
    sys.stdin = sys.stdin or os.fdopen(0, encoding="utf-8", closefd=False)
    sys.stdout = sys.stdout or os.fdopen(1, "w", encoding="utf-8", closefd=False)
    sys.stderr = sys.stderr or os.fdopen(2, "w", encoding="utf-8", closefd=False)


def say(text: str) -> None:
    """Write a line, or several, to standard error: what is in them from outside, such as names of files, steers no
    terminal.
    """
    put(f"{printable(text)}\n")


def put(text: str) -> None:
    """Write to standard error as it is. Where that is gone, as when its terminal was closed, nothing is reported, and
    the command goes on.
    """
    try:
        stream = standard_error()
        stream.write(text)
        stream.flush()
    except OSError:
        # The interpreter would try once more when it ends.
        with suppress(OSError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), standard_error().fileno())
