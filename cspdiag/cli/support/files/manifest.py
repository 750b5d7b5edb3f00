"""What ``compile`` has written into a folder: for each target a list of the generated files, and the program they were
generated from.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from contextlib import suppress
from hashlib import sha256

from cspdiag.base.record import record
from cspdiag.cli.support.failure import UsageError

MANIFEST = ".cspdiag-manifest"
"""The beginning of the name of each list, which ends with its target."""
_PROGRAM = "# program "


@record
class Manifest:
    """``digests`` are the SHA-256 of the generated files, by path: several if a generation was interrupted.

    ``program`` is the path of the program's text relative to the folder, "" if it is not known.
    """

    program: str
    digests: Mapping[str, frozenset[str]]


NOTHING = Manifest("", {})


def manifest_of(files: Mapping[str, str], program: str) -> Manifest:
    """The description of generated files, by path."""
    return Manifest(program, {path: frozenset((digest(text.encode()),)) for path, text in files.items()})


def digest(data: bytes) -> str:
    """The digest of a file, by which changes made by hand are recognized."""
    return sha256(data).hexdigest()


def manifest_name(target: str) -> str:
    """The name of the list of a target's files."""
    return f"{MANIFEST}-{target}"


def targets_in(folder: str) -> list[str]:
    """The targets of which a folder has a package."""
    prefix = manifest_name("")
    if not os.path.isdir(folder):
        return []
    return sorted(name.removeprefix(prefix) for name in os.listdir(folder) if name.startswith(prefix))


def manifest_text(*manifests: Manifest) -> str:
    """The list for the files of all manifests; the program is that of the last one."""
    rows = sorted(
        {(path, known) for manifest in manifests for path in manifest.digests for known in manifest.digests[path]}
    )
    program = manifests[-1].program
    head = f"{_PROGRAM}{program}\n" if program.isprintable() and program else ""
    return head + "".join(f"{known}  {path}\n" for path, known in rows)


def read_manifest(folder: str, target: str, *, force: bool) -> Manifest:
    """The contents of a list. Raises UsageError if cspdiag has not written it; with ``force`` that counts as empty."""
    place = os.path.join(folder, manifest_name(target))
    if not os.path.lexists(place):
        return NOTHING
    foreign = "it is a link" if os.path.islink(place) else "it is not a list of files"
    if os.path.isfile(place) and not os.path.islink(place):
        with suppress(UnicodeDecodeError), open(place, encoding="utf-8") as file:
            program, digests = _parsed(file.read())
            outside = next((path for path in digests if not _is_inside(path)), None)
            if outside is None:
                return Manifest(program, {path: frozenset(known) for path, known in digests.items()})
            foreign = f"it names {outside!r}"
    if force:
        return NOTHING
    raise UsageError(f"{place} was not written by cspdiag: {foreign} (--force ignores that)")


def _parsed(text: str) -> tuple[str, dict[str, set[str]]]:
    program = ""
    digests: dict[str, set[str]] = {}
    for line in text.removesuffix("\n").split("\n") if text else ():
        if line.startswith(_PROGRAM):
            program = line.removeprefix(_PROGRAM)
        else:
            known, _, path = line.partition("  ")
            digests.setdefault(path, set()).add(known)
    return program, digests


def _is_inside(path: str) -> bool:
    """Whether a path leads to a file below the folder that it is joined to, apart from links."""
    parts = path.replace("\\", "/").split("/")
    return not os.path.isabs(path) and not os.path.splitdrive(path)[0] and not {"", ".", ".."} & set(parts)
