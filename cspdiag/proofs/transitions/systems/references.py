"""What a thread communicates through: media as it sees them itself, so that instances that are alike share what they
do.

References are tuples, since they are looked up with every step of a thread. No two classes have values of the same
shape, so that references of different classes are never equal.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

from cspdiag.network.ir.actions import End
from cspdiag.proofs.transitions.classes.program import Node
from cspdiag.proofs.transitions.values import Known

Path: TypeAlias = tuple[str, ...]
"""Instances from the thread's own down."""


class OwnPort(NamedTuple):
    """What a port of the thread's own instance is attached to."""

    name: str
    element: int | None
    """Which of an array of ports."""


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
"""A medium as a thread sees it. Others access only ports and channels."""


class ReadingEnd(NamedTuple):
    """One end of those that read a medium: the process inside the thread that reads, and its end."""

    path: Path
    end: End


ParallelId: TypeAlias = tuple[Path, Node]
"""A parallel composition that a thread runs: the process in whose composition it stands, and where."""
