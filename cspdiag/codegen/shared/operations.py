"""Decisions about operations that are the same for every language: the negation of conditions, and comparisons with a
known result.
"""

from __future__ import annotations

from operator import eq, ge, gt, le, lt, ne

from cspdiag.base.record import replaced
from cspdiag.model.types import BoolType, IntType, TimeType, Type
from cspdiag.network.ir.expressions import BinaryOperation, Expression, LiteralValue, UnaryOperation, Value
from cspdiag.network.ir.faults import may_fault
from cspdiag.network.ir.ranges import needs_check

COMPARISONS = {"==": eq, "!=": ne, "<": lt, "<=": le, ">": gt, ">=": ge}
"""The operators as functions of two values."""

_OPPOSITES = {"==": "!=", "!=": "==", "<": ">=", "<=": ">", ">": "<=", ">=": "<"}


def opposite(condition: Expression) -> Expression | None:
    """The negation of a condition without ``not``, if there is one: for an order the opposite order, but not for reals,
    because of NaN.
    """
    match condition:
        case UnaryOperation(operator="not", operand=operand):
            return operand
        case BinaryOperation(operator=operator, left=left) if operator in _OPPOSITES:
            is_exact = operator in ("==", "!=") or isinstance(left.type, IntType | TimeType)
            return replaced(condition, operator=_OPPOSITES[operator]) if is_exact else None
        case _:  # No other condition has one.
            return None


def known_comparison(expression: BinaryOperation, *, by_name: bool) -> bool | None:
    """The result of a comparison of two literals, about which compilers and type checkers would rightly complain.

    ``by_name`` a named constant counts as a literal: compilers know its value, type checkers do not look it up.
    """
    left, right = (literal_value(side, by_name=by_name) for side in (expression.left, expression.right))
    compare = COMPARISONS.get(expression.operator)
    if compare is None or left is None or right is None:
        return None
    return bool(compare(left, right))


def literal_value(expression: Expression, *, by_name: bool) -> Value | None:
    """The value of a literal, which may have a sign."""
    match expression:
        case LiteralValue(value=value, name=name) if by_name or name is None:
            return value
        case UnaryOperation(operator="-", operand=LiteralValue(value=int(value) | float(value), name=name)) if (
            by_name or name is None
        ) and not may_fault(expression):
            return -value
        case _:  # No other expression is a literal.
            return None


def truth_of(comparison: BinaryOperation) -> tuple[Expression, bool] | None:
    """A condition that is compared with ``true`` or ``false``, and whether it holds when the comparison does."""
    other = comparison.right
    if comparison.operator not in ("==", "!=") or not isinstance(other, LiteralValue):
        return None
    is_truth = isinstance(other.type, BoolType)
    return (comparison.left, bool(other.value) == (comparison.operator == "==")) if is_truth else None


def range_check(expression: Expression) -> str | None:
    """The name of the function of a runtime that checks the result of an operation on whole numbers; None where it
    surely fits.
    """
    is_whole = isinstance(expression.type, IntType | TimeType)
    return integer_name(expression.type) if is_whole and needs_check(expression) else None


def integer_name(type_: Type) -> str:
    """``int64``, ``uint8``, ``duration``: the functions of the Python runtime that check a range; those of integers
    have the same names in C.
    """
    return f"{'' if type_.signed else 'u'}int{type_.bits}" if isinstance(type_, IntType) else "duration"
