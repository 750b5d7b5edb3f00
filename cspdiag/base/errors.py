"""The exceptions of the library, with one base class."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cspdiag.base.diagnostic import Diagnostic


class CspdiagError(Exception):
    """The base class of every exception that the library raises; the text says what is wrong and what helps.

    ``diagnostics`` are the places in the program that are wrong; empty if the program is not the cause.
    """

    diagnostics: Sequence[Diagnostic] = ()


class ArgumentError(CspdiagError, ValueError):
    """A function was called with a value that has no meaning for it."""


class MissingPackageError(CspdiagError, ImportError):
    """A package that only some functions need is not installed; the message names the extra to install."""


class FileError(CspdiagError, OSError):
    """A file cannot be read or written; it is also a FileNotFoundError, a PermissionError, …, as reported by the file
    system.
    """

    def __str__(self) -> str:
        reason = self.strerror or super().__str__()
        reason = f"{reason[:1].lower()}{reason[1:]}"
        return reason if self.filename is None else f"{self.filename}: {reason}"

    def __reduce__(self) -> tuple[object, ...]:
        return file_error, (OSError(self.errno, self.strerror, self.filename),)


def file_error(problem: OSError) -> FileError:
    """The problem as an exception of the library."""
    if isinstance(problem, FileError):
        return problem
    kind: type[FileError] = FileError
    if type(problem) is not OSError:
        kind = type("FileError", (FileError, type(problem)), {"__module__": __name__})
    return kind(problem.errno, problem.strerror, problem.filename)


@contextmanager
def file_errors() -> Iterator[None]:
    """Raises FileError for errors of the file system inside."""
    try:
        yield
    except OSError as problem:
        raise file_error(problem) from problem.__cause__


def missing_package(name: str, extra: str) -> MissingPackageError:
    """The error for a package in an extra of this distribution."""
    return MissingPackageError(f"this needs {name}: pip install 'cspdiag[{extra}]'", name=name)
