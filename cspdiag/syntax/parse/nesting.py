"""How deep a program may be nested, and room for passes that recurse over it."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

DEEPEST = 200
"""Levels of nesting that a syntax tree may have."""

_FRAMES = 5000
"""Of Python, for passes that take several calls a level; since 3.11 such calls take no room on the stack of C."""


@contextmanager
def room_to_recurse() -> Iterator[None]:
    """Raises Python's recursion limit for a pass over a tree of ``DEEPEST`` levels."""
    limit = sys.getrecursionlimit()
    sys.setrecursionlimit(max(limit, _FRAMES))
    try:
        yield
    finally:
        sys.setrecursionlimit(limit)
