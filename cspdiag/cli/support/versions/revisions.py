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
_COMMIT_OR_NAME_TWO = "commit it first, or name two files to compare: diff OLD NEW"


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


def _shown(revision: str, path: str) -> bytes:
    # The folder may not exist any more in the working tree.
    folder, rest = os.path.split(os.path.abspath(path))
    while not os.path.isdir(folder):
        folder, last = os.path.split(folder)
        rest = os.path.join(last, rest)
    git(
        path,
        folder,
        "rev-parse",
        "--verify",
        "--quiet",
        "--end-of-options",
        f"{revision}^{{commit}}",
        says=f"no revision {revision!r}" + (f": {_COMMIT_OR_NAME_TWO}" if revision == LAST_COMMIT else ""),
    )
    try:
        return git(path, folder, "show", "--end-of-options", f"{revision}:./{rest}")
    except UsageError:
        advice = f" ({_COMMIT_OR_NAME_TWO})" if revision == LAST_COMMIT else ""
        raise OSError(errno.ENOENT, f"not in revision {revision}{advice}", path) from None


def is_in_repository(folder: str) -> bool:
    """Whether a folder is in the working tree of a git repository. Raises UsageError without git."""
    try:
        return git(folder, folder, "rev-parse", "--is-inside-work-tree") == b"true\n"
    except _NoRepositoryError:
        return False


class _NoRepositoryError(UsageError):
    """There is no git repository."""


def git(path: str, folder: str, *arguments: str, says: str = "") -> bytes:
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
            raise _NoRepositoryError(f"{path} is not in a git repository: {_COMMIT_OR_NAME_TWO}")
        raise UsageError(f"git: {error or says}")
    return done.stdout
