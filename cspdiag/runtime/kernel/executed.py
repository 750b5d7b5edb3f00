"""What a task executes, as the scheduler and its reports know it."""

from __future__ import annotations


class Executed:
    """A process, or a part of optimized code.

    ``name`` is its path from the outermost process, ``source`` the file and line of its definition.
    """

    __slots__ = ()

    name: str
    source: str | None
