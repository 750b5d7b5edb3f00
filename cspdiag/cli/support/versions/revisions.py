"""Reads files as they were in a revision of a git repository."""

from __future__ import annotations

import errno
import os
import subprocess
from collections.abc import Callable

from cspdiag.base.sources import decoded, read_source
from cspdiag.base.span import SourceFile
from cspdiag.cli.support.failure import UsageError

Reader = Callable[[str], SourceFile]

LAST_COMMIT = "HEAD"
_OR_NAME_TWO = "or name two files to compare: diff OLD NEW"
_COMMIT_OR_NAME_TWO = f"commit it first, {_OR_NAME_TWO}"


def reader_of(revision: str | None) -> Reader:
    """A function that reads a file, named as in the working tree, in a revision; None is the working tree itself.

    It raises OSError if the revision has no such file, and UsageError if there is no such revision.
    """
    if revision is None:
        return read_source

    def read(path: str) -> SourceFile:
        return SourceFile(name=path, text=decoded(_shown(revision, path), path))

    return read


def split_name(name: str) -> tuple[str | None, str]:
    """``REVISION:FILE`` as in git, or the name of a file.

    As in git, the file is relative to the top of the repository, unless it begins with ``./`` or ``../``.
    """
    revision, colon, path = name.partition(":")
    if not colon or not revision or not path or os.path.exists(name):
        return None, name
    if not path.startswith(("./", "../")):
        top = git(path, os.curdir, "rev-parse", "--show-toplevel").decode().rstrip("\n")
        path = os.path.relpath(os.path.join(top, path))
    return revision, os.path.normpath(path)


def require_revision(revision: str, path: str, folder: str) -> None:
    """Raise UsageError if the repository of a folder has no such revision; ``path`` is the file concerned."""
    try:
        git(path, folder, "rev-parse", "--verify", "--quiet", "--end-of-options", f"{revision}^{{commit}}")
    except NoRepositoryError:
        raise
    except UsageError:
        if revision == LAST_COMMIT:
            advice = f"commit the programs first, {_OR_NAME_TWO}"
            raise UsageError(f"there is no commit in this repository yet: {advice}") from None
        raise UsageError(f"there is no revision {revision!r} in this repository") from None


def is_in(revision: str | None, path: str) -> bool:
    """Whether a revision, or the working tree (None), has a file. Raises UsageError if there is no such revision."""
    if revision is None:
        return os.path.exists(path)
    folder, rest = within(path)
    require_revision(revision, path, folder)
    try:
        git(path, folder, "cat-file", "-e", f"{revision}:./{rest}")
    except UsageError:
        return False
    return True


def within(path: str) -> tuple[str, str]:
    """The folder of a file, or the innermost one that exists still in the working tree, and the path from there."""
    folder, rest = os.path.split(os.path.abspath(path))
    while not os.path.isdir(folder):
        folder, last = os.path.split(folder)
        rest = os.path.join(last, rest)
    return folder, rest


def _shown(revision: str, path: str) -> bytes:
    folder, rest = within(path)
    require_revision(revision, path, folder)
    try:
        return git(path, folder, "show", "--end-of-options", f"{revision}:./{rest}")
    except UsageError:
        advice = f" ({_COMMIT_OR_NAME_TWO})" if revision == LAST_COMMIT else ""
        raise OSError(errno.ENOENT, f"not in revision {revision}{advice}", path) from None


def is_in_repository(folder: str) -> bool:
    """Whether a folder is in the working tree of a git repository. Raises UsageError without git."""
    try:
        return git(folder, folder, "rev-parse", "--is-inside-work-tree") == b"true\n"
    except NoRepositoryError:
        return False


class NoRepositoryError(UsageError):
    """There is no git repository."""


def git(path: str, folder: str, *arguments: str) -> bytes:
    """The output of git in a folder; ``path`` is the file concerned. Raises UsageError with what git says."""
    try:
        done = subprocess.run(
            ["git", "-C", folder, *arguments],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            check=False,
            env={**os.environ, "LC_ALL": "C"},
        )
    except FileNotFoundError:
        raise UsageError("reading a revision needs git, which is not installed") from None
    if done.returncode != 0:
        error = done.stderr.decode(errors="replace").strip().partition("\n")[0].removeprefix("fatal: ")
        if error.startswith("not a git repository"):
            raise NoRepositoryError(f"{path} is not in a git repository: {_COMMIT_OR_NAME_TWO}")
        raise UsageError(f"git: {error}")
    return done.stdout
