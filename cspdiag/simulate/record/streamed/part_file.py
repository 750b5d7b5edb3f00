"""The file of a recording while the run continues: next to its destination, under a name that says that it is a part.

``run.csv`` is ``run.part.csv`` until it is whole. What is written is there at once, without a buffer in this process:
if the process is killed, the part has it.
"""

from __future__ import annotations

import errno
import os
import stat
import tempfile
from contextlib import suppress
from typing import Protocol

from cspdiag.base.files.whole import require_name_of_file


class Sink(Protocol):
    """Where bytes go: all that are given, or OSError is raised."""

    def write(self, data: bytes | memoryview) -> object:
        """Write all of them."""
        ...

    def seekable(self) -> bool:
        """Whether it has places."""
        ...

    def seek(self, position: int) -> object:
        """Go to a place, from the beginning."""
        ...

    def truncate(self, size: int) -> object:
        """Cut it."""
        ...


def part_name(path: str, ending: str | None = None) -> str:
    """``run.part.csv`` for ``run.csv``; with another ending if one is given."""
    root, own = os.path.splitext(path)
    return f"{root}.part{own if ending is None else ending}"


def is_part_name(path: str) -> bool:
    """Whether a file has such a name: its run did not end, or has not ended yet."""
    root, _ = os.path.splitext(path)
    return root.endswith(".part")


class PartFile:
    """A ``Sink`` that becomes the file at ``path``; a device or a pipe is written to as it is.

    Raises OSError with the name that was given.
    """

    def __init__(self, path: str, part: str | None = None) -> None:
        require_name_of_file(path)
        self.path = path
        self._real = os.path.realpath(path)
        self.is_device = os.path.exists(path) and not os.path.isfile(path)
        self.part = path if self.is_device else part_name(self._real) if part is None else part
        if self.is_device:
            self._descriptor = _opened_device(path)
        else:
            if _is_locked(self.part):
                raise _another_run(path)
            with suppress(FileNotFoundError):
                os.unlink(self.part)
            self._descriptor = os.open(
                self.part, os.O_RDWR | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), 0o666
            )
            _lock(self._descriptor)
        self._seekable = not self.is_device and stat.S_ISREG(os.fstat(self._descriptor).st_mode)

    def write(self, data: bytes | memoryview) -> object:
        """See ``Sink``."""
        rest = memoryview(data)
        while rest:
            rest = rest[os.write(self._descriptor, rest) :]
        return None

    def seekable(self) -> bool:
        """See ``Sink``."""
        return self._seekable

    def seek(self, position: int) -> object:
        """See ``Sink``."""
        return os.lseek(self._descriptor, position, os.SEEK_SET)

    def truncate(self, size: int) -> object:
        """See ``Sink``."""
        os.ftruncate(self._descriptor, size)
        return None

    def put_in_place(self) -> None:
        """The file is whole: it takes its name, and the permissions of the file that it replaces."""
        if not self.is_device:
            own = os.fstat(self._descriptor)
            try:
                there = os.stat(self.part)
            except FileNotFoundError:
                there = None
            if there is None or (there.st_dev, there.st_ino) != (own.st_dev, own.st_ino):
                self.close()
                raise _another_run(self.path)
            with suppress(OSError):
                os.chmod(self.part, os.stat(self._real).st_mode & 0o7777)
        self.close()
        if not self.is_device:
            os.replace(self.part, self._real)

    def discard(self) -> None:
        """Leave nothing of it."""
        self.close()
        if not self.is_device:
            with suppress(FileNotFoundError):
                os.unlink(self.part)

    def close(self) -> None:
        """Close it, and leave it where it is."""
        if self._descriptor >= 0:
            descriptor, self._descriptor = self._descriptor, -1
            os.close(descriptor)


def _another_run(path: str) -> OSError:
    return OSError(errno.EEXIST, "another run writes to the same recording", path)


def _is_locked(part: str) -> bool:
    """Whether a run that continues writes to a part. What a killed one has left is locked by nobody."""
    try:
        descriptor = os.open(part, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0))
    except OSError:
        return False  # It is not there; or it cannot be replaced either, which says more.
    try:
        return not _lock(descriptor)
    finally:
        os.close(descriptor)


def _lock(descriptor: int) -> bool:
    """Lock a file until it is closed, where the system can; whether nobody else has."""
    try:
        import fcntl
    except ImportError:
        return True
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:  # Not every network has locks.
        return True
    return True


def journal_name(path: str) -> str:
    """Where the values of a file that can only be written at the end are until then: next to it, as MCAP, or in the
    folder for temporary files if the destination is a device or a pipe.
    """
    if os.path.exists(path) and not os.path.isfile(path):
        number, name = tempfile.mkstemp(suffix=".part.mcap")
        os.close(number)
        return name
    return part_name(os.path.realpath(path), ".mcap")


def _opened_device(path: str) -> int:
    """A device or a pipe to be written to, without waiting for a reader, which could take forever."""
    waits_not = getattr(os, "O_NONBLOCK", 0)
    try:
        number = os.open(path, os.O_WRONLY | waits_not)
    except OSError as problem:
        if problem.errno == errno.ENXIO:
            raise OSError(problem.errno, "it has no reader", path) from None
        raise
    os.set_blocking(number, True)
    return number
