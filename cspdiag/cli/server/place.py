"""Where a server listens, and for whom.

Each command with ``--server`` loads this before anything else, so it imports only what costs nothing.
"""

from __future__ import annotations

import _socket
import os
import sys

from cspdiag import __version__

AVAILABLE = hasattr(_socket, "SO_PEERCRED") and hasattr(os, "O_PATH")
"""Whether the system offers what a server needs (Linux): who is at the other end of a socket, and folders by number."""

PACKAGE = os.path.realpath(os.path.join(os.path.dirname(__file__), "..", ".."))
"""The folder of the package."""

_DECIDES_FOR_INTERPRETER = (b"PYTHON", b"LANG", b"LC_")
"""How the names of variables begin that an interpreter reads only when it starts."""

_OTHERS = 0o077

_PRIME = (1 << 61) - 1


def identity() -> str:
    """What has to be equal for a server to answer in place of this process: the program, the interpreter with its
    settings, and the file system that both see.
    """
    settings = sorted(item for item in os.environb.items() if item[0].startswith(_DECIDES_FOR_INTERPRETER))
    root = os.stat("/")
    seen = os.readlink("/proc/self/ns/mnt"), root.st_dev, root.st_ino
    return repr((__version__, PACKAGE, sys.version, sys.executable, tuple(sys.flags), settings, seen))


def name_of(identity: str) -> str:
    """The name of the socket of the servers with this identity; another identity may have the same."""
    return f"{int.from_bytes(os.fsencode(identity), 'big') % _PRIME:x}"


def has_own_options() -> bool:
    """Whether options of the interpreter were given, which a server would not have."""
    first = sys.orig_argv[1:2]
    return bool(first) and first[0].startswith("-") and first[0] != "-m"


def folder_path() -> str:
    """The folder of the sockets: ``cspdiag`` in ``$XDG_RUNTIME_DIR``, otherwise ``cspdiag/server`` in the cache."""
    base = os.environ.get("XDG_RUNTIME_DIR", "")
    if os.path.isabs(base):
        return os.path.join(base, "cspdiag")
    base = os.environ.get("XDG_CACHE_HOME", "")
    base = base if os.path.isabs(base) else os.path.expanduser("~/.cache")
    return os.path.join(base, "cspdiag", "server")


def open_folder(*, create: bool = False) -> int:
    """The number of the folder of the sockets. Raises OSError if it is missing, or is not for this user alone."""
    path = folder_path()
    if create:
        os.makedirs(path, mode=0o700, exist_ok=True)
    folder = os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    facts = os.fstat(folder)
    if facts.st_uid != os.geteuid() or facts.st_mode & _OTHERS:
        os.close(folder)
        raise PermissionError(f"{path} is not for its user alone")
    return folder


def address(folder: int, name: str) -> str:
    """The address of a socket; by the number of its folder, because an address has at most 107 bytes."""
    return f"/proc/self/fd/{folder}/{name}"


def connect(name: str) -> _socket.socket:
    """A connection to the server of this name. Raises OSError if there is none, or if it is that of another user."""
    folder = open_folder()
    connection = _socket.socket(_socket.AF_UNIX, _socket.SOCK_STREAM)
    try:
        connection.connect(address(folder, name))
        if not is_of_this_user(connection):
            raise PermissionError("a server of another user")
    except OSError:
        connection.close()
        raise
    finally:
        os.close(folder)
    return connection


def is_of_this_user(connection: _socket.socket) -> bool:
    """Whether the process at the other end belongs to the user of this one."""
    _, user, _ = peer(connection)
    return user == os.geteuid()


def peer(connection: _socket.socket) -> tuple[int, int, int]:
    """The process, the user and the group at the other end."""
    facts = connection.getsockopt(_socket.SOL_SOCKET, _socket.SO_PEERCRED, 12)
    process, user, group = (int.from_bytes(facts[at : at + 4], sys.byteorder) for at in (0, 4, 8))
    return process, user, group
