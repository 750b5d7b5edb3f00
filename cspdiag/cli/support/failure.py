"""Exit codes, and the failures that end a command with a message."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

from cspdiag.base.errors import missing_package

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


@contextmanager
def needed_packages(extra: str, *packages: str) -> Iterator[None]:
    """Imports inside need packages of an extra; if one is missing, the command says how to install them."""
    try:
        yield
    except ImportError as problem:
        if problem.name is None or problem.name.partition(".")[0] not in packages:
            raise
        raise UsageError(str(missing_package(packages[0], extra))) from None


def require_package(option: str, package: str, extra: str) -> None:
    """Refuse an option that needs a package which is not installed, before the work instead of after it."""
    from importlib.util import find_spec

    if find_spec(package) is None:
        raise UsageError(f'{option} needs {package}: pip install "cspdiag[{extra}]"')


def described(problem: OSError) -> str:
    """A file that cannot be read or written, with the reason, in one line."""
    if isinstance(problem, FileNotFoundError) and _is_in_removed_folder():
        return "the present folder does not exist any more"
    reason = reason_of(problem)
    if problem.filename is None:
        return reason
    from cspdiag.base.render.snippet import on_one_line

    return f"{on_one_line(problem.filename)}: {reason}"


def reason_of(problem: OSError) -> str:
    """Why a file cannot be read or written, as a part of a sentence."""
    reason = problem.strerror or str(problem)
    return f"{reason[:1].lower()}{reason[1:]}"


def _is_in_removed_folder() -> bool:
    try:
        os.getcwd()
    except OSError:
        return True
    return False
