"""The folder for what would otherwise be made again: parse tables, proofs, built programs.

Its contents are trusted and, if they are programs, executed. So it is used only if no other user may write into it.
"""

from __future__ import annotations

import errno
import os
import sys
from contextlib import suppress

_OTHERS_WRITE = 0o022


def cache_folder() -> str:
    """``cspdiag`` in ``$XDG_CACHE_HOME`` or ``~/.cache`` (XDG Base Directory Specification), created if it is missing.

    Raises OSError if it cannot be created, belongs to another user, or if others may write into it.
    """
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA") or os.path.expanduser("~/AppData/Local")
    else:
        base = os.environ.get("XDG_CACHE_HOME", "")
        # The specification ignores relative paths: they would depend on the present folder.
        base = base if os.path.isabs(base) else os.path.expanduser("~/.cache")
    folder = os.path.join(base, "cspdiag")
    os.makedirs(folder, mode=0o700, exist_ok=True)
    if sys.platform not in ("win32", "emscripten"):  # In a browser there is one user.
        facts = os.stat(folder)
        if facts.st_uid != os.geteuid() or facts.st_mode & _OTHERS_WRITE:
            raise PermissionError(errno.EACCES, "others may write into it, so nothing in it is trusted", folder)
    return folder


def store(path: str, content: bytes) -> None:
    """Stores a file of which other processes never see half. One that cannot be written is left out: it is made again
    when it is needed.
    """
    temporary = f"{path}.{os.getpid()}.tmp"
    try:
        with os.fdopen(os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as file:
            file.write(content)
        os.replace(temporary, path)
    except OSError:
        with suppress(OSError):
            os.unlink(temporary)
