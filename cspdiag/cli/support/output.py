"""Writes results: whole or not at all, and never over what somebody made by hand."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from hashlib import sha256

from cspdiag.cli.support.failure import UsageError

MANIFEST = ".cspdiag-manifest"
"""Names the generated files of a package, each with the SHA-256 of its text, so that changes made by hand are seen."""


def replace_text(path: str, text: str) -> None:
    """Write a text file as ``write_whole`` does."""
    from pathlib import Path

    from cspdiag.simulate.record.files import write_whole

    write_whole(Path(path), text.encode())


def write_package(folder: str, files: Mapping[str, str], *, force: bool) -> None:
    """Write the files of a generated package, by path relative to ``folder``.

    All files are written beside the folder first and then moved to their places. Files of an earlier generation that are no
    longer generated are removed; files that were never generated stay. Raises UsageError, having written nothing, where
    a file was changed or put there by hand, unless ``force``, where the folder or one in it is a symbolic link, so that files would be
    written or removed elsewhere, and where something else is in the way; OSError where a file cannot be written.
    """
    folder = folder.rstrip(os.sep)
    recorded = _recorded(folder, force=force)
    complete = {**files, MANIFEST: _manifest(files)}
    _refuse_links(folder, (*files, *recorded))
    _refuse_obstacles(folder, complete)
    if not force:
        _refuse_changes(folder, files, recorded)
    with _staging(folder) as staging:
        for path, text in complete.items():
            _write(os.path.join(staging, path), text)
        for path in complete:
            target = os.path.join(folder, path)
            os.makedirs(os.path.dirname(target), exist_ok=True)
            os.replace(os.path.join(staging, path), target)
    for path in recorded.keys() - files.keys():
        with suppress(OSError):
            os.unlink(os.path.join(folder, path))


def write_new_folder(folder: str, files: Mapping[str, str]) -> None:
    """Write files, by path relative to ``folder``, into a folder that does not exist yet or is empty.

    Raises UsageError where there is something already, OSError where a file cannot be written; then nothing is left.
    """
    if os.path.lexists(folder) and (os.path.islink(folder) or not os.path.isdir(folder) or os.listdir(folder)):
        raise UsageError(f"{folder} exists already")
    with _staging(folder) as staging:
        for path, text in files.items():
            _write(os.path.join(staging, path), text)
        os.replace(staging, folder)


@contextmanager
def _staging(folder: str) -> Iterator[str]:
    """A new folder beside ``folder``, which is removed in the end. An OSError speaks of the file in ``folder`` that was meant."""
    staging = _new_staging(folder)
    try:
        yield staging
    except OSError as problem:
        name = os.fspath(problem.filename or folder)
        meant = folder + name[len(staging) :] if name.startswith(staging) else name
        raise OSError(problem.errno, problem.strerror, meant) from None
    finally:
        _remove_tree(staging)


def _new_staging(folder: str) -> str:
    """A new folder beside ``folder``; nobody can have put another, or a link, in its place."""
    from secrets import token_hex

    staging = f"{folder}.{token_hex(8)}.tmp"
    os.makedirs(os.path.dirname(staging) or os.curdir, exist_ok=True)
    os.mkdir(staging)
    return staging


def _refuse_links(folder: str, paths: Iterable[str]) -> None:
    parents = {""}
    for path in paths:
        parts = path.split("/")[:-1]
        parents.update("/".join(parts[: count + 1]) for count in range(len(parts)))
    for parent in sorted(parents):
        place = os.path.join(folder, parent) if parent else folder
        if os.path.islink(place):
            raise UsageError(f"{place} is a symbolic link: remove it, nothing is written or removed through it")


def _refuse_obstacles(folder: str, paths: Iterable[str]) -> None:
    """Nothing is written where only a part could be: a folder has the name of a file, or the other way about."""
    for path in paths:
        place = os.path.join(folder, path)
        if os.path.isdir(place) and not os.path.islink(place):
            raise UsageError(f"{place} is in the way: it is a folder, and a file has this name")
        while (place := os.path.dirname(place)) and len(place) > len(folder):
            if os.path.lexists(place) and not os.path.isdir(place):
                raise UsageError(f"{place} is in the way: it is no folder")


def _write(path: str, text: str) -> None:
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "x", encoding="utf-8", newline="\n") as file:
        file.write(text)


def _remove_tree(folder: str) -> None:
    for parent, folders, names in os.walk(folder, topdown=False):
        for name in names:
            os.unlink(os.path.join(parent, name))
        for name in folders:
            os.rmdir(os.path.join(parent, name))
    with suppress(FileNotFoundError):
        os.rmdir(folder)


def _digest(text: str) -> str:
    return sha256(text.encode()).hexdigest()


def _manifest(files: Mapping[str, str]) -> str:
    return "".join(f"{_digest(text)}  {path}\n" for path, text in sorted(files.items()))


def _recorded(folder: str, *, force: bool) -> dict[str, str]:
    """What the manifest has. Raises UsageError for one that cspdiag has not written; with ``force`` that is none."""
    place = os.path.join(folder, MANIFEST)
    if not os.path.lexists(place):
        return {}
    pairs = [("", "", "")]
    with suppress(UnicodeDecodeError):
        if os.path.isfile(place):
            with open(place, encoding="utf-8") as file:
                pairs = [line.rstrip("\n").partition("  ") for line in file]
    foreign = next((path for _, _, path in pairs if not _is_inside(path)), None)
    if foreign is None and not os.path.islink(place):
        return {path: digest for digest, _, path in pairs}
    if force:
        return {}
    what = f"it names {foreign!r}" if foreign else "it is a link" if os.path.islink(place) else "it is no list of files"
    raise UsageError(f"{place} was not written by cspdiag: {what} (--force does without it)")


def _is_inside(path: str) -> bool:
    """Whether a path leads to a file below the folder that it is joined to, links aside."""
    parts = path.replace("\\", "/").split("/")
    return not os.path.isabs(path) and not os.path.splitdrive(path)[0] and not {"", ".", ".."} & set(parts)


def _refuse_changes(folder: str, files: Mapping[str, str], recorded: Mapping[str, str]) -> None:
    changed = [path for path in sorted({*files, *recorded}) if _is_hand_made(folder, path, files, recorded)]
    if not changed:
        return
    listed = ", ".join(changed[:3]) + (f" and {len(changed) - 3} more" if len(changed) > 3 else "")
    raise UsageError(f"{folder} holds files changed by hand: {listed} (--force overwrites them)")


def _is_hand_made(folder: str, path: str, files: Mapping[str, str], recorded: Mapping[str, str]) -> bool:
    place = os.path.join(folder, path)
    if not os.path.isfile(place):
        # A device or a pipe is not opened: nobody may ever write to it. A link that leads nowhere was made by hand too.
        return os.path.lexists(place)
    with open(place, "rb") as file:
        data = file.read()
    known = {recorded.get(path), _digest(files[path]) if path in files else None}
    return sha256(data).hexdigest() not in known
