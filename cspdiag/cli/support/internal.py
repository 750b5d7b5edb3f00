"""The report when cspdiag itself fails."""

from __future__ import annotations

import platform
import shlex
from collections.abc import Sequence
from traceback import extract_tb

from cspdiag import __version__

SHOWN_CALLS = 8


def describe(problem: BaseException, arguments: Sequence[str]) -> str:
    """A short report: what to send, and where the failure arose (innermost call last)."""
    calls = extract_tb(problem.__traceback__)[-SHOWN_CALLS:]
    where = "\n".join(f"    {call.filename}:{call.lineno} in {call.name}" for call in calls)
    kind = type(problem).__name__
    text = f"{kind}: {problem}".splitlines()[0]
    return (
        "cspdiag: internal error: this is a mistake in cspdiag, not in your program\n"
        "  please report it with the program and these lines:\n"
        f"  cspdiag {__version__}, Python {platform.python_version()}, {platform.platform()}\n"
        f"  command: cspdiag {shlex.join(arguments)}\n"
        f"  {text}\n{where}\n"
    )
