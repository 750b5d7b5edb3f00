"""The place of a server: at most one process has it, and leaves no file when it goes."""

from __future__ import annotations

import fcntl
import os
import socket
import struct
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from cspdiag.cli.server import place

LOCK = ".lock"
"""How the name of a lock ends; its beginning is that of the socket."""

_FLOCK = struct.Struct("hhqqi0q")
"""``struct flock`` of C: kind, from where the place counts, place, length, process."""


class Seat:
    """A place that this process has."""

    def __init__(self, folder: int, name: str) -> None:
        self._folder = folder
        self._name = name

    def listen(self) -> socket.socket:
        """The socket at this place; one that a killed server has left is replaced."""
        with suppress(FileNotFoundError):
            os.unlink(self._name, dir_fd=self._folder)
        listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        listener.bind(place.address(self._folder, self._name))
        listener.listen(64)
        return listener


@contextmanager
def seat(name: str) -> Iterator[Seat | None]:
    """The place of the servers with a name, or None if another process has it. Raises OSError."""
    folder = place.open_folder(create=True)
    lock = _locked(folder, name + LOCK)
    try:
        yield None if lock is None else Seat(folder, name)
    finally:
        if lock is not None:
            for file in (name, name + LOCK):
                with suppress(FileNotFoundError):
                    os.unlink(file, dir_fd=folder)
            os.close(lock)
            with suppress(OSError):
                os.rmdir(place.folder_path())
        os.close(folder)


def is_taken(name: str) -> bool:
    """Whether a process has the place of the servers with a name. Asking takes no lock, not even for a moment: a server
    that is starting would believe the place taken.
    """
    try:
        folder = place.open_folder()
    except OSError:
        return False
    try:
        lock = os.open(name + LOCK, os.O_RDWR | os.O_CLOEXEC | os.O_NOFOLLOW, dir_fd=folder)
    except OSError:
        return False
    finally:
        os.close(folder)
    try:
        found = fcntl.fcntl(lock, fcntl.F_GETLK, _FLOCK.pack(fcntl.F_WRLCK, os.SEEK_SET, 0, 0, 0))
    finally:
        os.close(lock)
    kind, *_ = _FLOCK.unpack(found)
    return bool(kind != fcntl.F_UNLCK)


def _locked(folder: int, name: str) -> int | None:
    """A lock, or None if another process has it."""
    while True:
        lock = os.open(name, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW, 0o600, dir_fd=folder)
        try:
            fcntl.lockf(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(lock)
            return None
        with suppress(FileNotFoundError):
            if os.path.samestat(os.fstat(lock), os.stat(name, dir_fd=folder)):
                return lock
        # The process that had it has removed it in between.
        os.close(lock)
