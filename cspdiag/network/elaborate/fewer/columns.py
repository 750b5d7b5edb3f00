"""The values of an index in all repetitions of a place, as one column.

A column is a ``range`` as long as that is possible, so most of what is asked of it takes the same for any number of
repetitions.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import chain, repeat
from math import prod
from typing import TypeAlias

from cspdiag.base import Report
from cspdiag.model.constants.evaluate import evaluate
from cspdiag.model.program import Program
from cspdiag.model.types import IntType
from cspdiag.syntax import ast

Column: TypeAlias = "range | list[int]"

_COMPUTED: Mapping[str, Callable[[int, int], int]] = {
    "+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.floordiv, "%": operator.mod,
}  # fmt: skip


class Repetitions:
    """The repetitions of a place inside replicators, the outermost first."""

    def __init__(self, program: Program, counts: Mapping[ast.Replicator, int]) -> None:
        self.program = program
        self.counts = counts
        self.number = prod(counts.values())

    def within(self, replicator: ast.Replicator) -> Repetitions | None:
        """The repetitions of a place inside a further replicator; None if their number is not known."""
        count = known(self.program, replicator.count)
        return None if count is None else Repetitions(self.program, {**self.counts, replicator: count})

    def of(self, replicator: ast.Replicator) -> Column:
        """The index of a replicator."""
        place = list(self.counts).index(replicator)
        sizes = list(self.counts.values())
        own, inner, outer = range(sizes[place]), prod(sizes[place + 1 :]), prod(sizes[:place])
        if inner == outer == 1:
            return own
        once = own if inner == 1 else [index for index in own for _ in range(inner)]
        return list(chain.from_iterable(repeat(once, outer)))

    def column(self, expression: ast.Expression) -> Column | None:
        """The values of an index; None if they are not known, or if computing one of them might fail."""
        found = self._value(expression)
        return [found] * self.number if isinstance(found, int) else found

    def _value(self, expression: ast.Expression) -> Column | int | None:
        """As ``column``, with one number for all repetitions if they are the same."""
        type_ = self.program.types.get(expression)
        if not isinstance(type_, IntType):
            return None
        found: Column | int | None = None
        match expression:
            case ast.Number(value=int(value)):
                found = value
            case ast.Name():
                found = self._name(expression)
            case ast.Binary(operator=sign, left=left, right=right) if sign in _COMPUTED:
                one, other = self._value(left), self._value(right)
                found = None if one is None or other is None else self._computed(sign, one, other)
            case _:  # No other index is computed by columns.
                return None
        if found is None or not (type_.minimum <= _least(found) and _greatest(found) <= type_.maximum):
            return None
        return found

    def _name(self, name: ast.Name) -> Column | int | None:
        symbol = self.program.bindings.get(name)
        if isinstance(symbol, ast.Constant):
            value = self.program.constants.get(symbol)
            return value if type(value) is int else None
        return self.of(symbol) if isinstance(symbol, ast.Replicator) and symbol in self.counts else None

    def _computed(self, sign: str, one: Column | int, other: Column | int) -> Column | int | None:
        # The quotient of negative numbers is rounded towards zero, and there is none by zero.
        if sign in ("/", "%") and (_least(one) < 0 or _least(other) <= 0):
            return None
        if isinstance(one, int) and isinstance(other, int):
            return _COMPUTED[sign](one, other)
        if sign == "+" and isinstance(one, int):
            one, other = other, one
        if isinstance(one, range) and isinstance(other, int) and sign in ("+", "-"):
            by = other if sign == "+" else -other
            return range(one.start + by, one.stop + by, one.step)
        return list(map(_COMPUTED[sign], _each(one), _each(other)))


def _each(values: Column | int) -> Iterable[int]:
    return repeat(values) if isinstance(values, int) else values


def _least(values: Column | int) -> int:
    if isinstance(values, int):
        return values
    return min(values[0], values[-1]) if isinstance(values, range) and values else min(values, default=0)


def _greatest(values: Column | int) -> int:
    if isinstance(values, int):
        return values
    return max(values[0], values[-1]) if isinstance(values, range) and values else max(values, default=0)


def are_below(values: Column, size: int) -> bool:
    """Whether all indexes are those of an array."""
    return _least(values) >= 0 and _greatest(values) < size


def chosen(among: Sequence[int], indexes: Column) -> Sequence[int]:
    """The elements at the indexes."""
    if isinstance(indexes, range) and indexes and indexes.step == 1:
        return among[indexes.start : indexes.stop]
    return list(map(among.__getitem__, indexes))


def known(program: Program, expression: ast.Expression) -> int | None:
    """A number that depends on constants only, and on nothing that fails."""
    report = Report()
    value = evaluate(program, expression, {}, report)
    return value if type(value) is int and not report.diagnostics else None
