"""The example programs by the names that users give."""

from __future__ import annotations

from cspdiag.base.files import examples
from cspdiag.cli.support.failure import UsageError


def files_of(example: str) -> dict[str, bytes]:
    """The files of an example by path, as ``examples.files_of`` finds them. Raises UsageError for an unknown name."""
    try:
        return examples.files_of(example)
    except examples.UnknownExampleError as problem:
        raise UsageError(str(problem)) from None
