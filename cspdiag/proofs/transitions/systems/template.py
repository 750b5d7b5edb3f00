"""Templates: the state machine of one thread of control, in terms of the thread itself, so instances that are alike
share it.

A thread is the outermost process or one branch of a parallel composition, with everything that it runs in sequence.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

from cspdiag.base import Span
from cspdiag.base.graphs import reached
from cspdiag.base.record import record
from cspdiag.proofs.transitions.classes.program import Node
from cspdiag.proofs.transitions.systems.labels import Fork, Label
from cspdiag.proofs.transitions.systems.references import ParallelId, Path, Reference
from cspdiag.proofs.transitions.systems.system import Abstraction
from cspdiag.proofs.transitions.values import Known


@record
class PlaceTemplate:
    """What a thread does in a state: words, the medium whose name follows them, where in the source text, and the path
    of the process inside the thread that does it.
    """

    uncompared: ClassVar[frozenset[str]] = frozenset()

    words: str
    reference: Reference | None = None
    span: Span | None = None
    path: Path = ()


@dataclass
class Parallel:
    """A parallel composition that a thread runs; whether its branches may be cancelled, and whether a fault in one of
    them is ``caught``.
    """

    path: Path
    node: Node
    cancellable: bool = False
    caught: bool = False


@dataclass
class Template:
    """The state machine of a thread.

    ``dependencies`` are the media on whose values or sharing the state machine depends, each with what was found there;
    ``written`` are the values that it may write to relevant media; ``accessed_variables`` those that it reads or
    writes.
    """

    edges: list[list[tuple[Label, int]]] = field(default_factory=list)
    places: list[PlaceTemplate] = field(default_factory=list)
    terminal: set[int] = field(default_factory=set)
    parallels: dict[ParallelId, Parallel] = field(default_factory=dict)
    dependencies: dict[Reference, object] = field(default_factory=dict)
    written: dict[Reference, set[Known]] = field(default_factory=dict)
    accessed_variables: set[Reference] = field(default_factory=set)
    abstractions: dict[Abstraction, None] = field(default_factory=dict)
    _repeated: dict[ParallelId, bool] = field(default_factory=dict)

    def repeats(self, parallel: ParallelId) -> bool:
        """Whether the parallel may be started more than once in one run of the thread."""
        known = self._repeated.get(parallel)
        if known is None:
            known = self._repeated[parallel] = self._starts_again(Fork(parallel))
        return known

    def _starts_again(self, fork: Label) -> bool:
        begin = [target for edges in self.edges for label, target in edges if label == fork]
        later = reached(begin, lambda state: [target for _, target in self.edges[state]])
        return any(label == fork for state in later for label, _ in self.edges[state])
