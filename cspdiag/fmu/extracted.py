"""The archive of an FMU as a folder, in the cache."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import zipfile
from hashlib import sha256
from tempfile import mkdtemp

from cspdiag.base.files.caches import cache_folder
from cspdiag.fmu.description import FmuDescription, FmuError, read_description
from cspdiag.fmu.platforms import platform_folder


def binary(path: str, description: FmuDescription, identifier: str) -> str:
    """The path of the binary inside the archive. Raises FmuError if there is none for this machine."""
    folder, suffix = platform_folder(description.version)
    wanted = f"binaries/{folder}/{identifier}{suffix}"
    with zipfile.ZipFile(path) as archive:
        names = archive.namelist()
    if wanted in names:
        return wanted
    there = sorted({name.split("/")[1] for name in names if re.fullmatch(r"binaries/[^/]+/[^/]+", name)})
    if there and folder not in there:
        message = f"{path} has binaries for {', '.join(there)}, none for this machine ({folder})"
    else:
        message = f"{path} has no {wanted}"
    raise FmuError(message, f"compile its sources, if it has some: fmpy compile {shlex.quote(path)}")


def extracted(path: str) -> str:
    """The folder with the contents of an archive, made if it is not in the cache.

    Raises FmuError for an archive with a file that would be outside of its folder, or that is damaged.
    """
    read_description(path)
    with open(path, "rb") as file:
        digest = sha256(file.read()).hexdigest()[:40]
    try:
        parent = os.path.join(cache_folder(), "fmus")
        target = os.path.join(parent, digest)
        if os.path.isdir(target):
            return target
        os.makedirs(parent, exist_ok=True)
        made = mkdtemp(dir=parent)
    except OSError as problem:
        raise FmuError(
            f"{problem.filename} cannot be written: {problem.strerror}", "XDG_CACHE_HOME names another"
        ) from None
    try:
        _extract(path, made)
        os.rename(made, target)
    except OSError:
        if not os.path.isdir(target):  # Another process was not faster.
            raise
    finally:
        shutil.rmtree(made, ignore_errors=True)
    return target


def _extract(path: str, folder: str) -> None:
    root = os.path.realpath(folder)
    with zipfile.ZipFile(path) as archive:
        for entry in archive.infolist():
            name = entry.filename.replace("\\", "/")
            place = os.path.normpath(os.path.join(root, name))
            if name.startswith("/") or not (place + os.sep).startswith(root + os.sep) or ":" in name:
                raise FmuError(
                    f"{path} has a file that leads outside of its folder: {entry.filename}", "do not trust it"
                )
        try:
            archive.extractall(folder)
        except (zipfile.BadZipFile, EOFError, RuntimeError) as problem:
            raise FmuError(f"{path} is damaged: {problem}", "export it again") from None
