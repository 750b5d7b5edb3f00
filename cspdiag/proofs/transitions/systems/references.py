"""The media that a thread communicates through, named relative to the thread, so instances that are alike share one
template.

References are tuples, since they are looked up with every step of a thread. No two classes have values of the same
shape, so references of different classes are never equal.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

from cspdiag.network.ir.actions import End
from cspdiag.proofs.transitions.classes.program import Node
from cspdiag.proofs.transitions.values import Known

Path: TypeAlias = tuple[str, ...]
"""Names of nested instances, from the one inside the thread's own instance down."""


class OwnPort(NamedTuple):
    """What a port of the thread's own instance is attached to."""

    name: str
    element: int | None
    """The index in an array of ports; None if the port is not an array."""


class InnerChannel(NamedTuple):
    """A channel of the instance at a path inside."""

    path: Path
    name: str


class Constant(NamedTuple):
    """A port that always reads the same value."""

    value: Known


class Discard(NamedTuple):
    """A port that is attached to nothing."""


Reference: TypeAlias = OwnPort | InnerChannel | Constant | Discard
"""A medium relative to a thread. Other threads can access only ports and channels."""


class ReadingEnd(NamedTuple):
    """One of the reading ends of a medium: the path of the process inside the thread that reads, and its end."""

    path: Path
    end: End


ParallelId: TypeAlias = tuple[Path, Node]
"""A parallel composition that a thread runs: the path of the process whose composition contains it, and its node there.
"""
