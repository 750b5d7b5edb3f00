"""The streams of a command: output for machines goes to standard output, output for people to standard error, in
colours if wanted.
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
    """Write to standard output, immediately and unchanged. Raises OSError, with its name, if that fails."""
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
    """Open streams for a process that was started with closed ones (``>&-``).

    For standard output and standard input it is one that refuses every call, so its user reports the error. Otherwise
    the next file that is opened would take its place, and output would go there.
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
    """Write one or several lines to standard error; control characters in them, as in names of files, have no
    effect.
    """
    put(f"{printable(text)}\n")


def put(text: str) -> None:
    """Write to standard error unchanged. If that fails, for example because its terminal was closed, nothing is
    reported, and the command continues.
    """
    try:
        stream = standard_error()
        stream.write(text)
        stream.flush()
    except OSError:
        # The interpreter would try once more when it ends.
        with suppress(OSError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), standard_error().fileno())
