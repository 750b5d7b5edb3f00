"""Where cspdiag keeps what it would otherwise make again: parse tables, proofs, built programs.

What is found there is believed and, as programs, executed. So the folder is one that nobody but its user may write
into, or it is not used.
"""

from __future__ import annotations

import errno
import os
import sys

_OTHERS_WRITE = 0o022


def cache_folder() -> str:
    """``cspdiag`` in ``$XDG_CACHE_HOME`` or ``~/.cache`` (XDG Base Directory Specification), made where it is missing.

    Raises OSError where it cannot be made, belongs to somebody else, or may be written into by others.
    """
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA") or os.path.expanduser("~/AppData/Local")
    else:
        base = os.environ.get("XDG_CACHE_HOME", "")
        # The specification has relative paths ignored: they would lead into whatever folder one happens to be in.
        base = base if os.path.isabs(base) else os.path.expanduser("~/.cache")
    folder = os.path.join(base, "cspdiag")
    os.makedirs(folder, mode=0o700, exist_ok=True)
    if sys.platform != "win32":
        facts = os.stat(folder)
        if facts.st_uid != os.geteuid() or facts.st_mode & _OTHERS_WRITE:
            raise PermissionError(errno.EACCES, "others may write into it, so that nothing in it is believed", folder)
    return folder
