"""A loop that is cut open, as matrices, and its minimal part with the same response."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from cspdiag.analyses.margins.law import Leaf
from cspdiag.base.record import record

if TYPE_CHECKING:
    import numpy

    Matrix = numpy.ndarray[tuple[int, ...], numpy.dtype[numpy.float64]]


@record
class Cut:
    """Where a loop is cut: a law, by its path, and a number within one of its outputs."""

    law: str
    output: Leaf

    @property
    def path(self) -> str:
        """The path of the law, and the output."""
        port, indexes = self.output
        return f"{self.law}.{port}{''.join(f'[{k}]' for k in indexes)}"

    @property
    def name(self) -> str:
        """The path without the outermost process."""
        return self.path.partition(".")[2]


@record
class OpenLoop:
    """x' = A x + B v, y = C x + D v, once every ``period`` seconds; v is the value last written at the cut, and y the
    value that the law computes.

    Negative feedback is part of y: the loop is closed by v = y. ``laws`` are the laws in the loop, that of the cut
    first.
    """

    cut: Cut
    period: float
    a: Matrix
    b: Matrix
    c: Matrix
    d: float
    laws: tuple[str, ...]
    states: tuple[tuple[str, Leaf], ...]
    """The state of each row of ``a``: a number of the ``plant``, of a law (by its path), ``held`` or in a ``latch`` at
    an output, or in a ``net``.
    """

    @property
    def kept(self) -> tuple[tuple[str, Leaf], ...]:
        """The states that depend on the cut and on which the cut depends."""
        return tuple(self.states[k] for k in kept_states(self))


def kept_states(loop: OpenLoop) -> list[int]:
    """Indexes of the states that depend on the cut and on which the cut depends: other joints, references and counters
    are dropped.
    """
    import numpy

    reached = _closure(abs(loop.a) > 0, abs(loop.b[:, 0]) > 0)
    seen = _closure(abs(loop.a.T) > 0, abs(loop.c[0]) > 0)
    return [int(k) for k in numpy.flatnonzero(reached & seen)]


def minimal(loop: OpenLoop) -> tuple[Matrix, Matrix, Matrix, float]:
    """The matrices over the kept states only."""
    import numpy

    kept = kept_states(loop)
    return loop.a[numpy.ix_(kept, kept)], loop.b[kept], loop.c[:, kept], loop.d


def _closure(moves: Any, start: Any) -> Any:
    """The states that depend on those in ``start``, where ``moves[i, j]`` means that i depends on j."""
    reached = start.copy()
    while True:
        more = reached | (moves & reached[None, :]).any(axis=1)
        if (more == reached).all():
            return reached
        reached = more
