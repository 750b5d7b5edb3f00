"""``cspdiag check --server``: has a server carry out the command, and starts one for the next time.

Whatever prevents it, the command is carried out by its own process, so there is always an answer, and the same one.
"""

from __future__ import annotations

import _socket
import os
import sys

from cspdiag.cli.server import messages, place

_PATIENCE = 1.0
"""How long a command waits for a server to be ready, in seconds."""
_TIME_TO_STOP = 5.0
"""How long a command waits after Ctrl-C, in seconds."""
_INTERRUPTED = 130
_INTERNAL_ERROR = 3

_PROGRAM = (
    "import sys; root, name = sys.argv[1:]; sys.path[:] = [path for path in sys.path if path]; "
    "root in sys.path or sys.path.insert(0, root); "
    "from cspdiag.cli.server.resident import serve; serve(name)"
)
"""What a server runs: it has no folder of its own from which modules could come."""


def wanted(arguments: list[str]) -> bool:
    """Whether a command line asks for a server."""
    return (
        arguments[:1] == ["check"]
        and "--server" in arguments
        and "--server-status" not in arguments
        and "--server-stop" not in arguments
    )


def answered(command: list[str]) -> int | None:
    """The exit code of a command, with the name of the program, that a server has carried out; None if this process has
    to do it.
    """
    if not place.AVAILABLE or place.has_own_options():
        return None
    if "-" in command and os.isatty(0):
        # A terminal belongs to the session of the command, not to that of the server.
        return None
    try:
        identity = place.identity()
        connection = place.connect(place.name_of(identity))
    except OSError:
        return None
    try:
        return _result(connection) if _is_accepted(connection, identity, command) else None
    finally:
        connection.close()


def _is_accepted(connection: _socket.socket, identity: str, command: list[str]) -> bool:
    """Whether the server is ready to carry out the command."""
    umask = os.umask(0o077)
    os.umask(umask)
    request = messages.CHECK, identity, [os.fsencode(word) for word in command], dict(os.environb), umask
    try:
        folder = os.open(".", os.O_PATH | os.O_DIRECTORY | os.O_CLOEXEC)
        try:
            connection.settimeout(_PATIENCE)
            messages.send(connection, request)
            if connection.recv(1) != messages.READY:
                return False
            messages.send_go(connection, [folder, 0, 1, 2])
            connection.settimeout(None)
            return True
        finally:
            os.close(folder)
    except OSError:
        return False


def _result(connection: _socket.socket) -> int | None:
    """The exit code; None if the server has ended without having done anything that can be seen."""
    touched = interrupted = False
    while True:
        try:
            reply = connection.recv(1)
            if reply == messages.TOUCHED:
                touched = True
                continue
            code = connection.recv(1) if reply == messages.END else b""
        except KeyboardInterrupt:
            if interrupted:
                return _INTERRUPTED
            interrupted = True
            if not _interrupt(connection):
                return _INTERRUPTED
            continue
        except OSError:
            code = b""
        if code:
            return code[0]
        if interrupted:
            return _INTERRUPTED
        if touched:
            sys.stderr.write("cspdiag: the server was ended before it had finished\n")
            return _INTERNAL_ERROR
        return None


def _interrupt(connection: _socket.socket) -> bool:
    try:
        connection.settimeout(_TIME_TO_STOP)
        return connection.send(messages.INTERRUPT) == 1
    except OSError:
        return False


def start() -> None:
    """Start a server for the next command, if that is possible and none is running.

    It has neither the terminal nor the standard streams of this process, and is the leader of its own session.
    """
    if not place.AVAILABLE or place.has_own_options():
        return
    nothing = [(os.POSIX_SPAWN_OPEN, number, os.devnull, os.O_RDWR, 0) for number in range(3)]
    try:
        os.close(place.open_folder(create=True))
        root, name = os.path.dirname(place.PACKAGE), place.name_of(place.identity())
        command = [sys.executable, "-c", _PROGRAM, root, name]
        os.posix_spawn(sys.executable, command, os.environb, file_actions=nothing, setsid=True, setsigmask=[])
    except (OSError, NotImplementedError):
        return
