"""The maximum depth of nesting, and a recursion limit for passes over trees of that depth."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

MAX_DEPTH = 200
"""Levels of nesting that a syntax tree may have."""

_FRAMES = 5000
"""Python's recursion limit for passes with several calls per level; since 3.11 such calls do not use the C stack."""


@contextmanager
def raised_recursion_limit() -> Iterator[None]:
    """Raises Python's recursion limit during a pass over a tree of up to ``MAX_DEPTH`` levels."""
    limit = sys.getrecursionlimit()
    sys.setrecursionlimit(max(limit, _FRAMES))
    try:
        yield
    finally:
        sys.setrecursionlimit(limit)
