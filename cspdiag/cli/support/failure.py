"""Exit codes, and the failures that end a command with a message."""

from __future__ import annotations

FINE = 0
UNSUCCESSFUL = 1
"""The program has errors, or a run ended unsuccessfully."""
WRONG_USAGE = 2
"""Wrong usage, or a file that cannot be read or written."""
INTERNAL_ERROR = 3
INTERRUPTED = 130
BROKEN_PIPE = 141
"""What a shell reports for a program that writes to a pipe nobody reads."""


class NoResultError(Exception):
    """The command was right but has no result; the message is for the person who gave it, a line or a few."""


class UsageError(Exception):
    """The command cannot be carried out as given; the message is one line for the person who gave it."""


def described(problem: OSError) -> str:
    """A file that cannot be read or written, and why, in one line."""
    reason = problem.strerror or str(problem)
    reason = f"{reason[:1].lower()}{reason[1:]}"
    if problem.filename is None:
        return reason
    from cspdiag.base.render.snippet import on_one_line

    return f"{on_one_line(problem.filename)}: {reason}"
