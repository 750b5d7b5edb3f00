"""What commands and servers say to each other.

A command sends a request and waits for ``READY``. Only after its ``GO`` the server begins, so a command that has waited
too long can carry itself out, and nothing is done twice. Its files come with ``GO``: a server that hangs does not hold
them, and what waits for the end of the output does not wait for the server. The server sends ``TOUCHED`` before
it first reads or writes the streams of the command: from then on the command cannot be carried out again. At the end
it sends ``END`` and the exit code. Ctrl-C is ``INTERRUPT``. If the command hangs up, it was killed.
"""

from __future__ import annotations

import _socket
import marshal
import sys

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Any

READY = b"R"
GO = b"G"
TOUCHED = b"T"
END = b"E"
INTERRUPT = b"I"

CHECK = "check"
STATUS = "status"
STOP = "stop"

_LENGTH = 4
_MAX_FILES = 4
_MAX_SIZE = 64 * 1024 * 1024


def send(connection: _socket.socket, message: Any) -> None:
    """Send what ``marshal`` can store. Raises OSError."""
    data = marshal.dumps(message)
    connection.sendall(len(data).to_bytes(_LENGTH, "big") + data)


def receive(connection: _socket.socket) -> Any:
    """What the other end has sent. Raises OSError and EOFError."""
    size = int.from_bytes(_exactly(connection, _LENGTH), "big")
    if size > _MAX_SIZE:
        raise EOFError("not a message")
    return marshal.loads(_exactly(connection, size))


def _exactly(connection: _socket.socket, size: int) -> bytes:
    data = b""
    while len(data) < size:
        part = connection.recv(size - len(data))
        if not part:
            raise EOFError("half a message")
        data += part
    return data


def send_go(connection: _socket.socket, files: Sequence[int]) -> None:
    """Send ``GO`` with open files. Raises OSError."""
    rights = b"".join(file.to_bytes(4, sys.byteorder) for file in files)
    connection.sendmsg([GO], [(_socket.SOL_SOCKET, _socket.SCM_RIGHTS, rights)])


def receive_go(connection: _socket.socket) -> list[int]:
    """The numbers that the files of the other end have here; none if it does not say ``GO``. Raises OSError."""
    go, ancillary, _, _ = connection.recvmsg(1, _socket.CMSG_SPACE(4 * _MAX_FILES))
    files = [
        int.from_bytes(rights[at : at + 4], sys.byteorder)
        for level, kind, rights in ancillary
        if (level, kind) == (_socket.SOL_SOCKET, _socket.SCM_RIGHTS)
        for at in range(0, len(rights), 4)
    ]
    return files if go == GO else []
