"""Carries out one command, in a process that the server has forked for it.

The process takes over what the command had: its folder, its streams, its environment. So it does what the command would
have done.
"""

from __future__ import annotations

import fcntl
import io
import marshal
import os
import signal
import socket
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, NoReturn, TextIO

from cspdiag.cli.main import main
from cspdiag.cli.server import messages, place
from cspdiag.cli.server.code import Code
from cspdiag.cli.server.memory import Memory

if TYPE_CHECKING:
    from typing_extensions import Buffer

_PATIENCE = 5.0
"""How long a command may take to send its request, in seconds."""
_INTERRUPTED = 130

LEAVE = b"leave"
"""What the process sends to the server, for it to end."""
USED = b"used"
"""What the process sends to the server: the programs that were checked follow."""


def carry_out(connection: socket.socket, to_server: int, code: Code, memory: Memory, status: dict[str, object]) -> None:
    """Answer whatever is asked over a connection; ``to_server`` is a pipe to the server."""
    connection.settimeout(_PATIENCE)
    match messages.receive(connection):
        case [messages.CHECK, str(identity), [*words], dict(environment), int(umask)]:
            if identity != place.identity():
                return
            if code.has_changed():
                os.write(to_server, LEAVE)
                return
            connection.sendall(messages.READY)
            files = messages.receive_go(connection)
            if not files:
                return
            _listen_to(connection)
            _become(connection, files, words, environment, umask)
            _finish(connection, _exit_code())
            _tell_uses(to_server, memory)
        case [messages.STATUS]:
            messages.send(connection, status)
        case [messages.STOP]:
            os.write(to_server, LEAVE)
            messages.send(connection, status)
        case _:
            # A request of another version, which gets no answer.
            return


def _exit_code() -> int:
    try:
        return main()
    except KeyboardInterrupt:
        return _INTERRUPTED


def _listen_to(connection: socket.socket) -> None:
    """From now on Ctrl-C of the command interrupts this process, and its end ends it."""
    connection.setblocking(True)
    process = os.getpid()

    def receive(*_: object) -> None:
        try:
            received = connection.recv(1, socket.MSG_DONTWAIT)
        except BlockingIOError:
            return
        except OSError:
            received = b""
        if received == messages.INTERRUPT:
            raise KeyboardInterrupt
        if not received:
            # As the signal would have ended the command, whatever it was doing.
            os.kill(process, signal.SIGTERM)

    signal.signal(signal.SIGIO, receive)
    fcntl.fcntl(connection, fcntl.F_SETOWN, process)
    fcntl.fcntl(connection, fcntl.F_SETFL, fcntl.fcntl(connection, fcntl.F_GETFL) | os.O_ASYNC)
    # What came before.
    receive()


def _become(
    connection: socket.socket, files: Sequence[int], words: Sequence[bytes], environment: dict[bytes, bytes], umask: int
) -> None:
    """Take over what the command has."""
    folder, *streams = files
    os.fchdir(folder)
    for number, stream in enumerate(streams):
        os.dup2(stream, number)
    for file in files:
        os.close(file)
    os.umask(umask)
    os.environb.clear()
    os.environb.update(environment)
    sys.argv = [os.fsdecode(word) for word in words]

    touched = False

    def touch() -> None:
        nonlocal touched
        if not touched:
            touched = True
            try:
                connection.sendall(messages.TOUCHED)
            except OSError:
                # The command has gone.
                _leave()

    sys.stdin = _text(io.BufferedReader(_Stream(0, "r", touch)), sys.stdin, is_lines=False)
    for name, number in (("stdout", 1), ("stderr", 2)):
        binary = io.BufferedWriter(_Stream(number, "w", touch))
        setattr(sys, name, _text(binary, getattr(sys, name), is_lines=number == 2 or os.isatty(number)))


def _text(binary: io.BufferedReader | io.BufferedWriter[_Stream], like: TextIO, *, is_lines: bool) -> io.TextIOWrapper:
    """A stream with the encoding that the interpreter has chosen for another, as it would for the command."""
    return io.TextIOWrapper(binary, like.encoding, like.errors, newline="\n", line_buffering=is_lines)


class _Stream(io.FileIO):
    """A standard stream that calls a function before it is read or written."""

    def __init__(self, number: int, mode: str, touch: Callable[[], None]) -> None:
        super().__init__(number, mode, closefd=False)
        self._touch = touch

    def readinto(self, buffer: Buffer, /) -> int:
        self._touch()
        return super().readinto(buffer)

    def readall(self) -> bytes:
        self._touch()
        return super().readall()

    def read(self, size: int | None = -1, /) -> bytes:
        self._touch()
        return super().read(-1 if size is None else size)

    def write(self, data: Buffer, /) -> int:
        self._touch()
        return super().write(data)


def _finish(connection: socket.socket, code: int) -> None:
    """Let the command end. Nothing of it is kept open for longer."""
    signal.signal(signal.SIGIO, signal.SIG_IGN)
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):
            stream.flush()
    nothing = os.open(os.devnull, os.O_RDWR)
    for number in range(3):
        os.dup2(nothing, number)
    os.chdir("/")
    with suppress(OSError):
        connection.sendall(messages.END + bytes([code]))
    connection.close()


def _tell_uses(to_server: int, memory: Memory) -> None:
    uses = [(use.main, use.imported) for use in memory.uses]
    with os.fdopen(to_server, "wb", closefd=False) as pipe:
        pipe.write(USED + marshal.dumps(uses))


def _leave() -> NoReturn:
    os._exit(0)
