"""Linear plants: the coefficients of derivatives, and the Runge-Kutta step as a polynomial in them.

The network says which states move so; what their coefficients are is found here again, by evaluating the derivatives.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from typing import Any

from cspdiag.base.record import record
from cspdiag.network.ir import expressions as ex
from cspdiag.network.ir.expression_walk import signals_read

Matrix = dict[tuple[str, str], float]
"""Entries by row and column; those that are not there are zero whatever the coefficients are."""


@record
class Linear:
    """The sum of states with coefficients and of what is held, if there is any. «Linear plants»"""

    terms: dict[str, float]
    rest: float | None = None


def linear(expression: ex.Expression, moving: Mapping[str, Any], value: Callable[[ex.Expression], Any]) -> Any:
    """An expression as a Linear, or an array of them; ``moving`` has the states and the signals that depend on them,
    ``value`` evaluates what does not.

    «Linear plants»
    """

    def inner(part: ex.Expression) -> Any:
        return linear(part, moving, value)

    if moving.keys().isdisjoint(signals_read(expression)):
        return Linear({}, rest=value(expression))
    match expression:
        case ex.SignalValue():
            return moving[expression.name]
        case ex.UnaryOperation(operator="-"):
            return _scaled(inner(expression.operand), lambda x: -x)
        case ex.BinaryOperation(operator="+"):
            return _joined(inner(expression.left), inner(expression.right), lambda x, y: x + y, lambda y: y)
        case ex.BinaryOperation(operator="-"):
            return _joined(inner(expression.left), inner(expression.right), lambda x, y: x - y, lambda y: -y)
        case ex.BinaryOperation(operator="*"):
            left, right = inner(expression.left), inner(expression.right)
            factor, scaled = (left, right) if right.terms else (right, left)
            return _scaled(scaled, lambda x: factor.rest * x)
        case ex.BinaryOperation(operator="/"):
            divisor = value(expression.right)
            return _scaled(inner(expression.left), lambda x: x / divisor)
        case ex.ArrayElements():
            return tuple(inner(part) for part in expression.values)
        case ex.ElementValue():
            return inner(expression.operand)[value(expression.index)]
        case _:  # No other operation is linear.
            raise AssertionError(expression)


def _scaled(x: Linear, scale: Callable[[float], float]) -> Linear:
    return Linear({n: scale(term) for n, term in x.terms.items()}, None if x.rest is None else scale(x.rest))


def _joined(
    left: Linear, right: Linear, both: Callable[[float, float], float], alone: Callable[[float], float]
) -> Linear:
    def joined(x: float | None, y: float | None) -> float | None:
        if y is None:
            return x
        return alone(y) if x is None else both(x, y)

    names = {**left.terms, **right.terms}
    terms = {name: joined(left.terms.get(name), right.terms.get(name)) for name in names}
    return Linear({name: x for name, x in terms.items() if x is not None}, joined(left.rest, right.rest))


def rk4(slopes: Mapping[str, Linear], x: Mapping[str, float], h: float, steps: int) -> dict[str, float]:
    """The states after ``steps`` steps of ``h`` seconds: x = M x + N r. «Linear plants»"""
    z = {(i, j): h * a for i, slope in slopes.items() for j, a in slope.terms.items()}
    s: Matrix = {(i, i): 1.0 for i in slopes}
    for divisor in (4, 3, 2):
        s = _plus_one({place: total / divisor for place, total in _product(z, s, slopes).items()}, slopes)
    m = _plus_one(_product(z, s, slopes), slopes)
    n = {place: h * entry for place, entry in s.items()}
    rest = {j: slope.rest for j, slope in slopes.items() if slope.rest is not None}
    for _ in range(steps):
        x = {i: _sum([*_row(m, i, slopes, x), *_row(n, i, slopes, rest)]) for i in slopes}
    return dict(x)


def _row(matrix: Matrix, i: str, order: Collection[str], factors: Mapping[str, float]) -> list[float]:
    return [matrix[i, j] * factors[j] for j in order if (i, j) in matrix and j in factors]


def _sum(terms: list[float]) -> float:
    total = terms[0]
    for term in terms[1:]:
        total = total + term
    return total


def _product(left: Matrix, right: Matrix, order: Collection[str]) -> Matrix:
    product: Matrix = {}
    for i in order:
        for j in order:
            shared = [k for k in order if (i, k) in left and (k, j) in right]
            if shared:
                product[i, j] = _sum([0.0, *(left[i, k] * right[k, j] for k in shared)])
    return product


def _plus_one(matrix: Matrix, order: Collection[str]) -> Matrix:
    return {**matrix, **{(i, i): 1.0 + matrix.get((i, i), 0.0) for i in order}}
