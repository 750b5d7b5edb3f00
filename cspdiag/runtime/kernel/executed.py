"""What a task executes, as seen by the scheduler and its reports."""

from __future__ import annotations


class Executed:
    """A process, or a part of optimized code.

    ``name`` is its path from the outermost process, ``source`` the file and line of its definition.
    """

    __slots__ = ()

    is_law = False
    """Whether it is a control law. A cancelled process ends before the law reads or before it writes."""

    has_computed = True
    """False from the beginning of a control law until it has computed, in a run that a policy leads."""

    name: str
    source: str | None
