"""Writes files completely or not at all, by way of temporary files next to them."""

from __future__ import annotations

import errno
import io
import os
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from typing import BinaryIO, Self

from cspdiag.base.files.interrupted import signals_held, signals_raised


def require_name_of_file(path: str | os.PathLike[str]) -> None:
    """Raise OSError for a name with a character that no file system takes."""
    try:
        if b"\0" not in os.fsencode(path):
            return
    except UnicodeEncodeError:
        pass
    raise OSError(errno.EINVAL, "no file has a name like this", ascii(os.fspath(path)))


def write_whole(path: str | os.PathLike[str], data: bytes) -> None:
    """Write a file whole or not at all; see ``whole_file``."""
    with whole_file(path) as file:
        file.write(data)


@contextmanager
def whole_file(path: str | os.PathLike[str]) -> Iterator[BinaryIO]:
    """A file to be written, which is at ``path`` when the block ends, whole; or not at all, if the block is left by an
    exception or a signal ends the process.

    A symbolic link keeps pointing where it points, a file keeps its permissions; a device or a pipe is written to as it
    is. Raises OSError as the file system does, with the name that was given, and for a pipe without a reader.
    """
    require_name_of_file(path)
    if os.path.exists(path) and not os.path.isfile(path):
        with _opened_through(path) as file:
            yield file
    else:
        with signals_raised(), _Staging() as staging:
            with staging.opened(os.fspath(path)) as file:
                yield file
            staging.put_in_place()


def replace_files(files: Mapping[str, bytes], folder: str | os.PathLike[str] | None = None) -> None:
    """Write the contents of files, by path; ``folder`` is made if it is not there, and stays only with them.

    All are first written next to their destinations, so none changes if one cannot be written, and then moved there,
    which no signal interrupts.
    Symbolic links keep their targets, files keep their permissions. Raises OSError with the given name.
    """
    with signals_raised(), _Staging() as staging:
        if folder is not None:
            staging.make_folder(os.fspath(folder))
        for path, data in files.items():
            with staging.opened(path) as file:
                file.write(data)
        staging.put_in_place()


class _Staging:
    """Files that are written next to their destinations until all are moved there. A context manager, which leaves none
    behind, and raises OSError with the name that was given.
    """

    def __init__(self) -> None:
        self._temporary: dict[str, tuple[str, str]] = {}
        self._path = ""
        self._made = ""

    def __enter__(self) -> Self:
        return self

    def make_folder(self, path: str) -> None:
        """Make the folder of the files unless it is there."""
        self._path = path
        with signals_held(), suppress(FileExistsError):
            os.mkdir(path)
            self._made = path

    @contextmanager
    def opened(self, path: str) -> Iterator[BinaryIO]:
        """A file for the contents of ``path``."""
        from secrets import token_hex

        self._path = path
        real = os.path.realpath(path)
        temporary = f"{real}.{token_hex(8)}.tmp"
        with ExitStack() as stack:
            with signals_held():
                file = stack.enter_context(open(temporary, "xb"))
                self._temporary[path] = temporary, real
            yield file

    def put_in_place(self) -> None:
        """Move all files, which are closed, to their destinations."""
        for temporary, real in self._temporary.values():
            with suppress(OSError):
                os.chmod(temporary, os.stat(real).st_mode & 0o7777)
        with signals_held():
            for path, (temporary, real) in self._temporary.items():
                self._path = path
                os.replace(temporary, real)

    def __exit__(self, kind: object, problem: BaseException | None, trace: object) -> None:
        with signals_held():
            for temporary, _ in self._temporary.values():
                with suppress(FileNotFoundError):
                    os.unlink(temporary)
            if self._made:
                with suppress(OSError):  # With files in it, it stays.
                    os.rmdir(self._made)
        if isinstance(problem, OSError):
            raise OSError(problem.errno, problem.strerror, self._path) from None


def _opened_through(path: str | os.PathLike[str]) -> BinaryIO:
    """A device or a pipe to be written to, without waiting for a reader, which could take forever."""
    waits_not = getattr(os, "O_NONBLOCK", 0)
    try:
        number = os.open(path, os.O_WRONLY | waits_not)
    except OSError as problem:
        if problem.errno == errno.ENXIO:
            raise OSError(problem.errno, "it has no reader", os.fspath(path)) from None
        raise
    os.set_blocking(number, True)
    return io.BufferedWriter(_Through(number, "wb"))


class _Through(io.FileIO):
    """A file without places: what is written to some devices is gone, and they say of any place that they are there."""

    def seek(self, *_: int) -> int:
        raise io.UnsupportedOperation("seek")

    def tell(self) -> int:
        raise io.UnsupportedOperation("tell")
