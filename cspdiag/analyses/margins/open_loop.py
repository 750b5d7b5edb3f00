"""A loop that was cut open, as matrices, and the least of it that has the same response."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from cspdiag.analyses.margins.law import Leaf
from cspdiag.base.record import record

if TYPE_CHECKING:
    import numpy

    Matrix = numpy.ndarray[tuple[int, ...], numpy.dtype[numpy.float64]]


@record
class Cut:
    """Where a loop is opened: a law, by its path, and a number within one of its outputs."""

    law: str
    output: Leaf

    @property
    def path(self) -> str:
        """The path of the law, and the output."""
        port, way = self.output
        return f"{self.law}.{port}{''.join(f'[{k}]' for k in way)}"

    @property
    def name(self) -> str:
        """As people call it: the path without the outermost process."""
        return self.path.partition(".")[2]


@record
class OpenLoop:
    """x' = A x + B v, y = C x + D v, once every ``period`` seconds; y is what the law computes where v was written the
    last time.

    Negative feedback is part of y: the loop is closed by v = y. ``laws`` are the laws within, that of the cut first.
    """

    cut: Cut
    period: float
    a: Matrix
    b: Matrix
    c: Matrix
    d: float
    laws: tuple[str, ...]
    states: tuple[tuple[str, Leaf], ...]
    """What each row of ``a`` is: a number of the ``plant``, of a law (by its path), one ``held`` or in a ``latch`` at
    an output, or in a ``net``.
    """

    @property
    def kept(self) -> tuple[tuple[str, Leaf], ...]:
        """The states that the cut moves and that move the cut."""
        return tuple(self.states[k] for k in kept_states(self))


def kept_states(loop: OpenLoop) -> list[int]:
    """Indexes of the states that the cut moves and that move the cut: other joints, references and counters
    fall away.
    """
    import numpy

    reached = _closure(abs(loop.a) > 0, abs(loop.b[:, 0]) > 0)
    seen = _closure(abs(loop.a.T) > 0, abs(loop.c[0]) > 0)
    return [int(k) for k in numpy.flatnonzero(reached & seen)]


def minimal(loop: OpenLoop) -> tuple[Matrix, Matrix, Matrix, float]:
    """The matrices over those states only."""
    import numpy

    kept = kept_states(loop)
    return loop.a[numpy.ix_(kept, kept)], loop.b[kept], loop.c[:, kept], loop.d


def _closure(moves: Any, start: Any) -> Any:
    """The states that can be reached from some, where ``moves[i, j]`` says that j moves i."""
    reached = start.copy()
    while True:
        more = reached | (moves & reached[None, :]).any(axis=1)
        if (more == reached).all():
            return reached
        reached = more
