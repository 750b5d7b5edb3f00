"""Which versions of which programs ``cspdiag diff`` compares, and what could be read of them."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from cspdiag.base.errors import CspdiagError
from cspdiag.base.record import record, replaced
from cspdiag.base.span import SourceFile
from cspdiag.cli.support.failure import UsageError, described
from cspdiag.cli.support.versions.revisions import (
    LAST_COMMIT,
    git,
    is_in,
    is_in_repository,
    reader_of,
    require_revision,
    split_name,
    within,
)

if TYPE_CHECKING:
    from argparse import Namespace

    from cspdiag.base import Diagnostic
    from cspdiag.draw.differences.programs import Difference
    from cspdiag.model.program import Program
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
    """What changed in a program, which had the path ``former`` before. ``errors``: why definitions could not be read,
    in both versions; ``failure``: why nothing could be. ``programs`` are both versions, None if one could not be read.
    """

    path: str
    former: str
    difference: Difference
    errors: Sequence[Diagnostic] = ()
    failure: str = ""
    programs: tuple[Program, Program] | None = None

    @property
    def problems(self) -> list[str]:
        """Why not everything could be compared, a line each."""
        lines = [f"{problem.span}: {problem.code}: {problem.message}" for problem in self.errors]
        return [*lines, self.failure] if self.failure else lines


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
    return [_of_file(path, revision or arguments.start or LAST_COMMIT, arguments.end)]


def compared(before: Version, after: Version, *, imported: bool = True) -> Comparison:
    """What changed from one version to the other, in ``imported`` files, too, unless there is only one version. Raises
    OSError for a file that cannot be read.
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
    difference = differences(
        first.readable, second.readable, whole=whole, imported=imported and before.exists and after.exists
    )
    return Comparison(after.path, before.path, difference, errors, programs=(first.readable, second.readable))


def all_compared(pairs: Iterable[tuple[Version, Version]]) -> list[Comparison]:
    """What changed in each of the programs that changed, and which definitions moved from one to another. One that
    cannot be read is no reason not to compare the others.
    """
    from cspdiag.draw.differences.moves import ComparedFile, with_moves
    from cspdiag.draw.differences.programs import Difference

    found = []
    for before, after in pairs:
        try:
            found.append(compared(before, after, imported=False))
        except UnreadableError as problem:
            found.append(Comparison(after.path, before.path, Difference(), problem.diagnostics, str(problem)))
        except OSError as problem:
            found.append(Comparison(after.path, before.path, Difference(), failure=described(problem)))
    read = {number: each.programs for number, each in enumerate(found) if each.programs is not None}
    files = [ComparedFile(found[number].path, *programs, found[number].difference) for number, programs in read.items()]
    gone = set()
    for number, difference in zip(read, with_moves(files), strict=True):
        if found[number].difference.changes and not difference.changes and not found[number].problems:
            gone.add(number)
        found[number] = replaced(found[number], difference=difference)
    # Where definitions came from is said where they are now.
    return [each for number, each in enumerate(found) if number not in gone]


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


def _of_file(path: str, start: str, end: str | None) -> tuple[Version, Version]:
    """A file in two revisions, in one of which it may have another path, or not be. Raises UsageError if it is in
    neither.
    """
    before, after = Version(start, path), Version(end, path)
    exists = [is_in(each.revision, path) for each in (before, after)]
    if all(exists):
        return before, after
    if not any(exists):
        where = "here" if end is None else f"in revision {end}"
        raise UsageError(f"{path}: there is no such file, neither {where} nor in revision {start}")
    folder, _ = within(path)
    top = git(path, folder, "rev-parse", "--show-toplevel").decode().rstrip("\n")
    place = os.path.realpath(path)
    for first, second in _changes(top, start, end):
        if place in (os.path.join(top, first.path), os.path.join(top, second.path)):
            return _seen_from_here(first, top), _seen_from_here(second, top)
    return before, after  # Git does not know it: what is missing is said when it is read.


def _seen_from_here(version: Version, top: str) -> Version:
    return replaced(version, path=os.path.relpath(os.path.join(top, version.path)))


def _changed(start: str, end: str | None) -> list[tuple[Version, Version]]:
    """The programs at or below the current folder that differ in two revisions."""
    if not is_in_repository(os.curdir):
        raise UsageError("this folder is not in a git repository: name two files to compare: diff OLD NEW")
    for revision in (start, end):
        if revision is not None:
            require_revision(revision, os.curdir, os.curdir)
    return _changes(os.curdir, start, end)


def _changes(folder: str, start: str, end: str | None) -> list[tuple[Version, Version]]:
    """The programs at or below a folder that differ in two revisions, in the order of git, with paths from that folder;
    renamed files have another path in each.
    """
    revisions = [start] if end is None else [start, end]
    options = ("--relative", "--find-renames", "--no-ext-diff", "--name-status", "-z")
    words = iter(
        os.fsdecode(git(folder, folder, "diff", *options, "--end-of-options", *revisions, "--", "*.csp"))
        .rstrip("\0")
        .split("\0")
    )
    found = []
    for status in words:
        if status:
            former = next(words)
            path = next(words) if status.startswith(("R", "C")) else former
            found.append((Version(start, former, exists=status != "A"), Version(end, path, exists=status != "D")))
    return found
