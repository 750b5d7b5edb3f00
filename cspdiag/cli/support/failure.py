"""Exit codes, and the failures that end a command with a message."""

from __future__ import annotations

import os

FINE = 0
UNSUCCESSFUL = 1
"""The program has errors, or a run ended unsuccessfully."""
WRONG_USAGE = 2
"""Wrong usage, or a file that cannot be read or written."""
INTERNAL_ERROR = 3
INTERRUPTED = 130
BROKEN_PIPE = 141
"""The exit code that a shell reports for a program that writes to a pipe without a reader."""


class NoResultError(Exception):
    """The command was right but has no result; the message for its user has one or a few lines."""


class UsageError(Exception):
    """The command cannot be carried out as given; the message for its user has one line."""


def described(problem: OSError) -> str:
    """A file that cannot be read or written, with the reason, in one line."""
    if isinstance(problem, FileNotFoundError) and _is_in_removed_folder():
        return "the present folder does not exist any more"
    reason = problem.strerror or str(problem)
    reason = f"{reason[:1].lower()}{reason[1:]}"
    if problem.filename is None:
        return reason
    from cspdiag.base.render.snippet import on_one_line

    return f"{on_one_line(problem.filename)}: {reason}"


def _is_in_removed_folder() -> bool:
    try:
        os.getcwd()
    except OSError:
        return True
    return False
