"""Whether files have the content that they had."""

from __future__ import annotations

import hashlib
import os
import stat
from functools import lru_cache
from typing import TypeAlias

Stamp: TypeAlias = "tuple[int, int, int]"


def stamp_of(found: os.stat_result) -> Stamp:
    """Its identity, size and time of change: another one for a file that has another content."""
    return found.st_ino, found.st_size, found.st_mtime_ns


def stamp_of_file(path: str) -> Stamp | None:
    """The stamp of the file at a path; None if there is none, or it cannot be looked at."""
    try:
        return stamp_of(os.stat(path))
    except (OSError, ValueError):
        return None


def digest_of_file(path: str) -> str | None:
    """The same for the same content; None if there is none, or it cannot be read. A file is read again only if its
    identity, size or time of change is another one.
    """
    try:
        found = os.stat(path)
        if not stat.S_ISREG(found.st_mode):
            return None
        return _digest(path, stamp_of(found))
    except (OSError, ValueError):
        return None


@lru_cache(maxsize=256)
def _digest(path: str, stamp: Stamp) -> str:
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
