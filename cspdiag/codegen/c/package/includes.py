"""Which files of a package a file needs."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping
from functools import lru_cache

_INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)


def with_headers(paths: Iterable[str], files: Mapping[str, str], folders: Iterable[str]) -> list[str]:
    """The paths with those of all headers that they include, looked for in ``folders`` among ``files``, sorted."""
    found: set[str] = set()
    pending = list(paths)
    while pending:
        path = pending.pop()
        if path not in found:
            found.add(path)
            names = included_in(files[path])
            pending += [place for name in names for folder in folders if (place := os.path.join(folder, name)) in files]
    return sorted(found)


@lru_cache(maxsize=512)
def included_in(text: str) -> tuple[str, ...]:
    """The names in quotes that a text in C includes."""
    return tuple(_INCLUDE.findall(text))
