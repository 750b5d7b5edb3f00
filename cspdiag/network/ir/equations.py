"""The equations of control laws, and calls of laws in other languages."""

from __future__ import annotations

from functools import cached_property
from itertools import takewhile

from cspdiag.base import Span
from cspdiag.base.record import record
from cspdiag.model.types import Type
from cspdiag.network.ir.declared import Declared
from cspdiag.network.ir.expression_walk import signals_read
from cspdiag.network.ir.expressions import Expression


@record(kw_only=True)
class ExternalBody:
    """A body in another language: ``target`` is ``module.py:Class``, a C file, an FMU or the name of a device, and
    ``span`` is where it is named.

    ``method`` and ``step``, in nanoseconds, are those of the integration of an FMU for model exchange.
    """

    language: str
    target: str
    span: Span
    method: str = "rk4"
    step: int | None = None


@record(kw_only=True)
class SubmodelEquation(Declared):
    """``name = value``; ``name`` is an output or a local. Nested submodels are inlined: ``pid.error`` is a local."""

    type: Type
    value: Expression

    @cached_property
    def reads(self) -> tuple[str, ...]:
        """The names of the signals that it reads, each once."""
        return tuple(signals_read(self.value))


@record(kw_only=True)
class ExternalCall(Declared):
    """A nested external submodel (its instance is ``name``): one call with all ``inputs`` computes all ``outputs``."""

    external: ExternalBody
    definition: str
    arguments: tuple[tuple[str, Expression], ...]
    inputs: tuple[tuple[str, Expression], ...]
    outputs: tuple[tuple[str, str, Type], ...]
    """Port, local name (``pan.encoder``), type."""

    @cached_property
    def reads(self) -> tuple[str, ...]:
        """The names of the signals that it reads, each once."""
        expressions = (value for _, value in self.arguments + self.inputs)
        return tuple(dict.fromkeys(name for expression in expressions for name in signals_read(expression)))


@record
class LinearRow:
    """What the next value of a state is the sum of: products with the states ``of``, then with the ``held`` values.

    Both are positions, in order. ``keeps`` says that the state itself is a term, with the coefficient one.
    """

    of: tuple[int, ...]
    held: tuple[int, ...]
    keeps: bool


@record(kw_only=True)
class LinearBlock:
    """Continuous states x of an environment with ``dx/dt = A x + r``, where A is constant and r is held over a step.

    A step of the classical Runge-Kutta method over h is then ``x = M x + N r``, with ``M = I + h A S``, ``N = h S`` and
    ``S = I + h A/2 (I + h A/3 (I + h A/4))``. No other derivative reads these states. ``matrix`` has a row of A for
    each state, None where its derivative does not read a state; the values are known, and finite. ``held`` has the r of
    each state, a signal or a literal, or None; it is computed before the step, after ``equations``.
    """

    states: tuple[str, ...]
    matrix: tuple[tuple[Expression | None, ...], ...]
    equations: tuple[SubmodelEquation, ...]
    held: tuple[Expression | None, ...]

    @cached_property
    def rows(self) -> tuple[LinearRow, ...]:
        """The terms of each row of M x + N r: those that a product of at most four factors A, or three for N, has."""
        reads = [{j for j, entry in enumerate(row) if entry is not None} for row in self.matrix]
        rows = []
        for state in range(len(self.states)):
            reached, latest, returns = {state}, {state}, False
            for _ in range(3):
                latest = set().union(*(reads[j] for j in latest))
                returns = returns or state in latest
                reached |= latest
            held = tuple(j for j in sorted(reached) if self.held[j] is not None)
            latest = set().union(*(reads[j] for j in latest))
            rows.append(LinearRow(tuple(sorted(reached | latest)), held, not (returns or state in latest)))
        return tuple(rows)

    @property
    def instance(self) -> str:
        """The path of the innermost instance that contains all states; the first state if there is none."""
        levels = zip(*(state.split(".")[:-1] for state in self.states), strict=False)
        shared = takewhile(lambda level: len(set(level)) == 1, levels)
        return ".".join(level[0] for level in shared) or self.states[0]
