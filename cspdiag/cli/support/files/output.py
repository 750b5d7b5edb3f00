"""Writes results: completely or not at all, and never over files made by hand."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress

from cspdiag.base.files.interrupted import signals_held
from cspdiag.base.files.whole import write_whole
from cspdiag.cli.support.failure import UsageError
from cspdiag.cli.support.files.manifest import (
    Manifest,
    digest,
    manifest_name,
    manifest_of,
    manifest_text,
    read_manifest,
    targets_in,
)


def replace_text(path: str, text: str) -> None:
    """Write a text file as ``write_whole`` does."""
    write_whole(path, text.encode())


def write_package(folder: str, files: Mapping[str, str], target: str, *, program: str = "", force: bool) -> None:
    """Write the files of a package that was generated for ``target``, by path relative to ``folder``.

    All files are written beside the folder first and then moved to their places. Files of an earlier generation for the
    target that are no longer generated are removed, with the folders that this leaves empty; files that were never
    generated stay, and so does what was generated for another target. Signals that end the process wait until all of it
    is done; even if the machine stops before, generated files are recognized as such the next time. ``program`` is the
    path of the program's text from ``folder``, if it has one.
    Raises UsageError, having written nothing, if a file was changed or put there by hand or belongs to another target
    (unless ``force``), if the folder or one in it is a symbolic link, so files would be written or removed elsewhere,
    and if something else is in the way; OSError if a file cannot be written.
    """
    folder = folder.rstrip(os.sep)
    listed = manifest_name(target)
    recorded = read_manifest(folder, target, force=force)
    others = {other: read_manifest(folder, other, force=True) for other in targets_in(folder) if other != target}
    _refuse_links(folder, (*files, *recorded.digests))
    _refuse_obstacles(folder, (*files, listed))
    generated = manifest_of(files, program)
    if not force:
        _refuse_other_targets(folder, generated, target, others)
        _refuse_changes(folder, generated, recorded)
    whole = f"{listed}.whole"
    lists = {listed: manifest_text(recorded, generated), whole: manifest_text(generated)}
    with _staging(folder) as staging:
        for path, text in {**files, **lists}.items():
            _write(os.path.join(staging, path), text)
        for path in (listed, *files):
            place = os.path.join(folder, path)
            os.makedirs(os.path.dirname(place), exist_ok=True)
            os.replace(os.path.join(staging, path), place)
        for path in recorded.digests.keys() - files.keys():
            if not any(path in other.digests for other in others.values()):
                _remove(folder, path)
        os.replace(os.path.join(staging, whole), os.path.join(folder, listed))


def write_new_folders(folder: str, files: Mapping[str, bytes]) -> None:
    """Write files by path relative to ``folder``, of which the first step is a folder that does not exist yet or is
    empty. Raises UsageError if there is something in one already, OSError if a file cannot be written.
    """
    names = list(dict.fromkeys(path.partition("/")[0] for path in files))
    for name in names:
        _refuse_existing(os.path.join(folder, name))
    with signals_held():
        for name in names:
            place = os.path.join(folder, name)
            inside = {path.partition("/")[2]: content for path, content in files.items() if path.startswith(f"{name}/")}
            write_new_folder(place, inside)


def write_new_folder(folder: str, files: Mapping[str, str | bytes]) -> None:
    """Write files, by path relative to ``folder``, into a folder that does not exist yet or is empty.

    Raises UsageError if there is something already, OSError if a file cannot be written; then nothing is left.
    """
    _refuse_existing(folder)
    with _staging(folder) as staging:
        for path, text in files.items():
            _write(os.path.join(staging, path), text)
        os.replace(staging, folder)


def _refuse_existing(folder: str) -> None:
    """Refuse a folder that has something in it, or that is something else."""
    if os.path.lexists(folder) and (os.path.islink(folder) or not os.path.isdir(folder) or os.listdir(folder)):
        raise UsageError(f"{folder} exists already")


@contextmanager
def _staging(folder: str) -> Iterator[str]:
    """A new folder next to ``folder``, which is removed at the end; signals wait for it. An OSError names the file in
    ``folder`` that was meant.
    """
    with signals_held():
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
    """A new folder next to ``folder``, which no other process can have replaced, even by a link."""
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
    """Refuse to write if only a part could be written: a folder has the name of a file, or the other way round."""
    for path in paths:
        place = os.path.join(folder, path)
        if os.path.isdir(place) and not os.path.islink(place):
            raise UsageError(f"{place} is in the way: it is a folder, and a file has this name")
        while (place := os.path.dirname(place)) and len(place) > len(folder):
            if os.path.lexists(place) and not os.path.isdir(place):
                raise UsageError(f"{place} is in the way: it is not a folder")


def _write(path: str, content: str | bytes) -> None:
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "xb") as file:
        file.write(content.encode() if isinstance(content, str) else content)


def _remove_tree(folder: str) -> None:
    for parent, folders, names in os.walk(folder, topdown=False):
        for name in names:
            os.unlink(os.path.join(parent, name))
        for name in folders:
            os.rmdir(os.path.join(parent, name))
    with suppress(FileNotFoundError):
        os.rmdir(folder)


def _remove(folder: str, path: str) -> None:
    """Remove a generated file, its compiled form, and folders that become empty."""
    place = os.path.join(folder, path)
    parent, name = os.path.split(place)
    module, is_module = name.removesuffix(".py"), name.endswith(".py")
    kept = os.path.join(parent, "__pycache__")
    with suppress(OSError):
        os.unlink(place)
        if is_module and os.path.isdir(kept) and not os.path.islink(kept):
            for entry in os.listdir(kept):
                if entry.startswith(f"{module}.") and entry.endswith(".pyc"):
                    os.unlink(os.path.join(kept, entry))
            with suppress(OSError):
                os.rmdir(kept)
        while len(parent) > len(folder):
            os.rmdir(parent)
            parent = os.path.dirname(parent)


def _refuse_other_targets(folder: str, generated: Manifest, target: str, others: Mapping[str, Manifest]) -> None:
    for other, manifest in others.items():
        for path, known in sorted(generated.digests.items()):
            if not known <= manifest.digests.get(path, known) and os.path.lexists(os.path.join(folder, path)):
                raise UsageError(
                    f"{folder} has the package for {other}, and the one for {target} has a {path} too: "
                    "give another folder with -o (--force overwrites what both have)"
                )


def _refuse_changes(folder: str, generated: Manifest, recorded: Manifest) -> None:
    known = (generated.digests, recorded.digests)
    changed = [
        path
        for path in sorted({*generated.digests, *recorded.digests})
        if _is_hand_made(os.path.join(folder, path), frozenset().union(*(digests.get(path, ()) for digests in known)))
    ]
    if not changed:
        return
    listed = ", ".join(changed[:3]) + (f" and {len(changed) - 3} more" if len(changed) > 3 else "")
    raise UsageError(f"{folder} holds files changed by hand: {listed} (--force overwrites them)")


def _is_hand_made(place: str, known: frozenset[str]) -> bool:
    if not os.path.isfile(place):
        # A device or a pipe is not opened: it might never deliver anything. A broken link was made by hand, too.
        return os.path.lexists(place)
    with open(place, "rb") as file:
        return digest(file.read()) not in known
