"""Which versions of which programs ``cspdiag diff`` compares, and what could be read of them."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING

from cspdiag.base.errors import CspdiagError
from cspdiag.base.record import record
from cspdiag.base.span import SourceFile
from cspdiag.cli.support.failure import UsageError
from cspdiag.cli.support.versions.revisions import LAST_COMMIT, git, reader_of, split_name

if TYPE_CHECKING:
    from argparse import Namespace

    from cspdiag.base import Diagnostic
    from cspdiag.draw.differences.programs import Difference
    from cspdiag.pipeline import Checked


@record
class Version:
    """A program in a revision, None for the working tree; ``exists``: not, if it was added later or is removed."""

    revision: str | None
    path: str
    exists: bool = True

    def __str__(self) -> str:
        return f"{self.path} in {self.revision}" if self.revision else self.path


@record
class Comparison:
    """What changed in a program. ``errors``: why definitions could not be read, in both versions."""

    path: str
    difference: Difference
    errors: Sequence[Diagnostic]


def versions(arguments: Namespace) -> list[tuple[Version, Version]]:
    """The pairs of versions to be compared. Raises UsageError for arguments that do not fit together."""
    if arguments.old is None:
        return _changed(arguments.start or LAST_COMMIT, arguments.end)
    if arguments.new is not None:
        if arguments.start is not None or arguments.end is not None:
            raise UsageError("--from and --to are for the revisions of one file")
        return [(Version(*split_name(arguments.old)), Version(*split_name(arguments.new)))]
    revision, path = split_name(arguments.old)
    if revision is not None and arguments.start is not None:
        raise UsageError(f"{arguments.old} names a revision, and so does --from")
    return [(Version(revision or arguments.start or LAST_COMMIT, path), Version(arguments.end, path))]


def compared(before: Version, after: Version, *, imported: bool = True) -> Comparison:
    """What changed from one version to the other, in ``imported`` files, too. Raises OSError for a file that cannot be
    read.
    """
    from cspdiag.draw.differences.programs import differences

    first, second = _checked(before), _checked(after)
    errors = [
        problem for checked in (first, second) if checked.program is None for problem in checked.report.diagnostics
    ]
    if first.readable is None:
        raise UnreadableError(before, errors)
    if second.readable is None:
        raise UnreadableError(after, errors)
    whole = (first.program is not None, second.program is not None)
    return Comparison(after.path, differences(first.readable, second.readable, whole=whole, imported=imported), errors)


class UnreadableError(CspdiagError):
    """Nothing of a version could be read; the diagnostics say why."""

    def __init__(self, version: Version, diagnostics: Sequence[Diagnostic]) -> None:
        super().__init__(f"{version} cannot be read as a program")
        self.diagnostics = diagnostics


def _checked(version: Version) -> Checked:
    from cspdiag.pipeline import check

    read = reader_of(version.revision)
    source = read(version.path) if version.exists else SourceFile(name=version.path, text="")
    return check(source, read)


def _changed(start: str, end: str | None) -> list[tuple[Version, Version]]:
    """The programs at or below the current folder that differ in two revisions, in the order of git."""
    revisions = [start] if end is None else [start, end]
    options = ("--relative", "--no-renames", "--no-ext-diff", "--name-status", "-z")
    found = git(os.curdir, os.curdir, "diff", *options, "--end-of-options", *revisions, "--", "*.csp")
    words = os.fsdecode(found).split("\0")
    return [
        (Version(start, path, exists=status != "A"), Version(end, path, exists=status != "D"))
        for status, path in zip(words[:-1:2], words[1::2], strict=True)
    ]
