"""Evaluates sizes and indexes, once the values of parameters are known."""

from __future__ import annotations

from collections.abc import Mapping

from cspdiag.base import Report
from cspdiag.base.record import replaced
from cspdiag.model.constants.evaluate import evaluate
from cspdiag.model.program import Program, Value
from cspdiag.model.types import ArrayType, IntType, Type
from cspdiag.network.diagnostics.arrays import SizeNotPositive, TooManyInstances
from cspdiag.syntax import ast

LARGEST_PROCESS = 100_000
"""A process with more elements of one kind is refused."""

Values = Mapping[ast.Node, Value]


class Sizes:
    """Evaluates the sizes of a program, and reports impossible ones."""

    def __init__(self, program: Program, report: Report) -> None:
        self.program = program
        self.report = report

    def integer(self, expression: ast.Expression, values: Values) -> int | None:
        """The value of a size or an index; None if it is unknown or was reported."""
        if isinstance(expression, ast.Number) and isinstance(expression.value, int):
            return expression.value
        if isinstance(expression, ast.Name):
            symbol = self.program.bindings.get(expression)
            if isinstance(symbol, ast.Replicator):
                found = values.get(symbol)
                return found if isinstance(found, int) else None
        if isinstance(expression, ast.Binary):
            neighbour = self._neighbour(expression, values)
            if neighbour is not None:
                return neighbour
        value = evaluate(self.program, expression, values, self.report)
        return value if isinstance(value, int) and not isinstance(value, bool) else None

    def _neighbour(self, expression: ast.Binary, values: Values) -> int | None:
        """The value of an index such as ``i + 1``, as ``evaluate`` computes it; None for any other expression."""
        index, number = expression.left, expression.right
        if not (isinstance(index, ast.Name) and isinstance(number, ast.Number) and isinstance(number.value, int)):
            return None
        symbol = self.program.bindings.get(index)
        found = values.get(symbol) if isinstance(symbol, ast.Replicator) else None
        if not isinstance(found, int) or not 0 <= found <= LARGEST_PROCESS or number.value > LARGEST_PROCESS:
            return None
        if not self.program.poisoned.isdisjoint((expression, index, number)):
            return None
        match expression.operator:
            case "+":
                value = found + number.value
            case "-":
                value = found - number.value
            case _:  # Any other operator may fail.
                return None
        type_ = self.program.types.get(expression)
        return value if isinstance(type_, IntType) and type_.minimum <= value <= type_.maximum else None

    def size(
        self, expression: ast.Expression, what: str, values: Values, *, least: int = 1, times: int = 1
    ) -> int | None:
        """The number of elements of something; None if it is unknown, and a report if it is less than ``least``, or if
        the product with the counts of all ``for`` around it and with ``times`` exceeds LARGEST_PROCESS.
        """
        size = self.integer(expression, values)
        if size is None:
            return None
        if size < least:
            self.report.add(SizeNotPositive(span=expression.span, what=what, size=size, least=least))
            return None
        total = size * times
        for outer in [key for key in values if isinstance(key, ast.Replicator)]:
            total *= self.integer(outer.count, values) or 0
        if total > LARGEST_PROCESS:
            self.report.add(TooManyInstances(span=expression.span, what=what, number=total, limit=LARGEST_PROCESS))
            return None
        return size

    def repeated(
        self, replicator: ast.Replicator, what: str, values: Values, times: int = 1
    ) -> list[dict[ast.Node, Value]] | None:
        """The values inside each repetition; None if their number is unknown or was reported. ``times`` is the number
        of iterations of loops around this place that are not among the values.
        """
        count = self.size(replicator.count, what, values, least=0, times=times)
        return None if count is None else [{**values, replicator: index} for index in range(count)]

    def type_of(self, declared: ast.TypeName | None, known: Type, values: Values) -> Type:
        """A type with its parameter-dependent sizes filled in."""
        if declared is None or not declared.dimensions or not isinstance(known, ArrayType):
            return known
        sizes = [self.integer(dimension, values) for dimension in declared.dimensions]
        return _with_sizes(known, sizes)


def _with_sizes(known: Type, sizes: list[int | None]) -> Type:
    if not sizes or not isinstance(known, ArrayType):
        return known
    inner = _with_sizes(known.element, sizes[1:])
    return replaced(known, element=inner, size=sizes[0] if known.size is None else known.size)
