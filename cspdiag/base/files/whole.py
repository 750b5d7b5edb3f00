"""Writes files completely or not at all, by way of temporary files next to them."""

from __future__ import annotations

import errno
import os
from collections.abc import Mapping
from contextlib import suppress


def require_name_of_file(path: str | os.PathLike[str]) -> None:
    """Raise OSError for a name with a character that no file system takes."""
    try:
        if b"\0" not in os.fsencode(path):
            return
    except UnicodeEncodeError:
        pass
    raise OSError(errno.EINVAL, "no file has a name like this", ascii(os.fspath(path)))


def write_whole(path: str | os.PathLike[str], data: bytes) -> None:
    """Write a file whole or not at all.

    A symbolic link keeps pointing where it points, a file keeps its permissions; a device or a pipe is written to as it
    is. Raises OSError as the file system does, with the name that was given, and for a pipe without a reader.
    """
    require_name_of_file(path)
    if os.path.exists(path) and not os.path.isfile(path):
        _write_through(path, data)
    else:
        replace_files({os.fspath(path): data})


def replace_files(files: Mapping[str, bytes]) -> None:
    """Replace the contents of existing files, by path.

    All are first written next to their destinations, so none changes if one cannot be written, and then moved there.
    Symbolic links keep their targets, files keep their permissions. Raises OSError with the given name.
    """
    from secrets import token_hex

    staged: dict[str, tuple[str, str]] = {}
    path = ""
    try:
        for path, data in files.items():
            real = os.path.realpath(path)
            temporary = f"{real}.{token_hex(8)}.tmp"
            with open(temporary, "xb") as file:
                staged[path] = temporary, real
                file.write(data)
            with suppress(OSError):
                os.chmod(temporary, os.stat(real).st_mode & 0o7777)
        for path, (temporary, real) in staged.items():  # noqa: B007 - the handler below names it
            os.replace(temporary, real)
    except OSError as problem:
        raise OSError(problem.errno, problem.strerror, path) from None
    finally:
        for temporary, _ in staged.values():
            with suppress(FileNotFoundError):
                os.unlink(temporary)


def _write_through(path: str | os.PathLike[str], data: bytes) -> None:
    """Write to a device or a pipe without waiting for a reader, which could take forever."""
    waits_not = getattr(os, "O_NONBLOCK", 0)
    try:
        number = os.open(path, os.O_WRONLY | waits_not)
    except OSError as problem:
        if problem.errno == errno.ENXIO:
            raise OSError(problem.errno, "nobody reads from it", os.fspath(path)) from None
        raise
    os.set_blocking(number, True)
    with os.fdopen(number, "wb") as file:
        file.write(data)
