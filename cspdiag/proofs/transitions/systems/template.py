"""What following one thread of control gives: states and edges in terms of the thread, so that instances that are alike share it.

A thread is the outermost process or one branch of a parallel composition, with everything that it runs in sequence.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar, TypeAlias

from cspdiag.base import Span
from cspdiag.base.record import record
from cspdiag.network.ir.actions import End
from cspdiag.proofs.transitions.program import Node
from cspdiag.proofs.transitions.systems.system import Abstraction, EventKind
from cspdiag.proofs.transitions.values import Known

Path: TypeAlias = tuple[str, ...]
"""Instances from the thread's own down."""

Reference: TypeAlias = tuple[Any, ...]
"""A medium as a thread sees it: ``("port", name, index)`` of its own instance, ``("channel", path, name)`` of one inside, ``("constant", value)``, ``("discard",)``."""

ReadingEnd: TypeAlias = tuple[Path, End]
"""One end of those that read a medium: the process inside the thread that reads, and its end."""

ParallelId: TypeAlias = tuple[Path, Node]
"""A parallel composition that a thread runs: the process in whose composition it stands, and where."""

Label: TypeAlias = tuple[Any, ...]
"""What an edge does, its kind first:

- ``("internal",)``
- ``("read", reference, value, reading end)``, ``("write", reference, value)``, ``("guarded", reference, value)``: on a channel; the last by an output guard
  A fifth part ``LATE`` of a read: with alternatives only, by the guard of an interrupt whose body has come to its end
- ``("bind", reference)``, ``("bound", reference)``: an alternative chooses to write to one whose guard is only ready, which has not read yet
- ``("delivered", reference)``, ``("withdrawn", reference)``: the writer of a broadcast goes on, or was cancelled
- ``("input", reference, value)``, ``("sample", reference, value)``, ``("miss", reference)``, ``("ready", reference)``, ``("output", reference, value)``: with the outside
- ``("time", words)``, and ``("time", words, INSTANT)`` for a delay that may be over at once
- ``("alarm", reference, "read" or "write", reading end or None)``: somebody else would read or write there, seen at the end of a guard
- ``("load", reference, value)``, ``("store", reference, value)``: a shared variable
- ``("fork", parallel)``, ``("join", parallel)``, ``("cancel", parallel)``, ``("thrown", parallel, branch, exception)``: as the parent of a parallel
- ``("start",)``, ``("end",)``, ``("cancelled",)``, ``("throw", exception)``: as a branch

A value is UNKNOWN where it is not followed.
"""

INTERNAL_LABEL: Label = ("internal",)

ALONE: dict[str, tuple[EventKind, bool]] = {
    "input": ("external", True),
    "output": ("external", True),
    "sample": ("sample", True),
    "miss": ("miss", False),
    "ready": ("ready", False),
}
"""Labels that involve nobody else: the kind of their events, and whether specifications see them."""

INSTANT = "instant"
LATE = "late"


def is_late(label: Label) -> bool:
    """Whether a label is a read in which only an alternative of somebody else takes part."""
    return len(label) == 5 and label[4] == LATE


@record
class Spot:
    """What a thread does in a state: words, the medium that they end with, the place in the text, and the process inside the thread that does it."""

    uncompared: ClassVar[frozenset[str]] = frozenset()

    words: str
    reference: Reference | None = None
    span: Span | None = None
    path: Path = ()


@dataclass
class Parallel:
    """A parallel that a thread runs, whether its branches may be cancelled, and whether a fault of theirs is ``caught``."""

    path: Path
    node: Node
    cancellable: bool = False
    caught: bool = False


@dataclass
class Template:
    """The state machine of a thread.

    ``asked`` are the media whose values or sharing the machine depends on, with the answers; ``written`` what it may write to relevant media; ``touched``
    the variables that it accesses.
    """

    edges: list[list[tuple[Label, int]]] = field(default_factory=list)
    spots: list[Spot] = field(default_factory=list)
    terminal: set[int] = field(default_factory=set)
    parallels: dict[ParallelId, Parallel] = field(default_factory=dict)
    asked: dict[Reference, object] = field(default_factory=dict)
    written: dict[Reference, set[Known]] = field(default_factory=dict)
    touched: set[Reference] = field(default_factory=set)
    abstractions: dict[Abstraction, None] = field(default_factory=dict)
    _repeated: dict[ParallelId, bool] = field(default_factory=dict)

    def repeats(self, parallel: ParallelId) -> bool:
        """Whether the parallel may be started again in one run of the thread."""
        known = self._repeated.get(parallel)
        if known is None:
            known = self._repeated[parallel] = self._starts_again(("fork", parallel))
        return known

    def _starts_again(self, fork: Label) -> bool:
        pending = [target for edges in self.edges for label, target in edges if label == fork]
        seen = set(pending)
        while pending:
            for label, target in self.edges[pending.pop()]:
                if label == fork:
                    return True
                if target not in seen:
                    seen.add(target)
                    pending.append(target)
        return False
