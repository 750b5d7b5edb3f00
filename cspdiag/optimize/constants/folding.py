"""Constant folding: values of expressions at compile time, only where every target computes the same bits."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, assert_never

from cspdiag.base.record import replaced
from cspdiag.model.types import (
    BOOL,
    ArrayType,
    BoolType,
    EnumType,
    IntType,
    RealType,
    StructType,
    TextType,
    TimeType,
    Type,
    UnknownType,
)
from cspdiag.network.elaborate.constant_value import constant_value
from cspdiag.network.ir.everywhere import rewritten
from cspdiag.network.ir.expression_walk import operands
from cspdiag.network.ir.expressions import (
    ArrayElements,
    BinaryOperation,
    ConditionalValue,
    ElementValue,
    Expression,
    FieldValue,
    FunctionCall,
    LiteralValue,
    StructValue,
    UnaryOperation,
    Value,
    VariableValue,
)
from cspdiag.network.ir.faults import may_fault
from cspdiag.optimize.check.expressions import agrees

LIBRARY_FUNCTIONS = frozenset({"exp", "log", "sin", "cos", "tan", "asin", "acos", "atan", "atan2"})
"""Functions whose last bit depends on the library of the target machine."""

EXACT_SECONDS = 2**53
"""Durations in nanoseconds below this are exact as doubles, so every target divides them in the same way."""


def literal(value: Value, kind: Type, like: Expression) -> LiteralValue:
    """A value at the source place of an expression."""
    return LiteralValue(type=kind, span=like.span, value=value)


def is_literal(expression: Expression | None, value: object) -> bool:
    """Whether an expression is this truth value."""
    return isinstance(expression, LiteralValue) and expression.value is value


def folded_with(expression: Expression, variables: Mapping[str, LiteralValue]) -> Expression:
    """The expression folded with the values of some variables known."""

    def change(part: Any) -> Any:
        if isinstance(part, VariableValue):
            value = variables.get(part.channel)
            return part if value is None else replaced(value, type=part.type, span=part.span)
        return folded(part)

    return rewritten(expression, change)


def folded(expression: Expression) -> Expression:
    """The expression, or its constant value; its operands have already been folded.

    An operation that would fault stays, and so does one whose bits depend on the machine. Whatever is removed cannot
    fault. The result is at the place of the expression, so a condition stays at its place.
    """
    result = _simplified(expression)
    return result if result.span is expression.span else replaced(result, span=expression.span)


def _simplified(expression: Expression) -> Expression:
    match expression:
        case LiteralValue():
            return expression
        case BinaryOperation(operator="and" | "or"):
            return _logic(expression)
        case ConditionalValue(condition=LiteralValue(value=bool(value))):
            return expression.then if value else expression.otherwise
        case FieldValue(operand=StructValue(values=values)) if not any(map(may_fault, values)):
            assert isinstance(expression.operand.type, StructType)
            return values[[name for name, _ in expression.operand.type.fields].index(expression.field)]
        case ElementValue(operand=ArrayElements(values=values), index=LiteralValue(value=int(index))) if (
            0 <= index < len(values) and not any(map(may_fault, values))
        ):
            return values[index]
        case UnaryOperation(operator="not", operand=UnaryOperation(operator="not", operand=inner)):
            return inner
        case _ if all(isinstance(operand, LiteralValue) for operand in operands(expression)):
            return _evaluated(expression)
        case BinaryOperation():
            return _without_neutral(expression)
        case _:  # Its operands are not known, or it has none.
            return expression


def _logic(expression: BinaryOperation) -> Expression:
    decisive = expression.operator == "or"
    if is_literal(expression.left, decisive):
        return literal(decisive, BOOL, expression)
    if is_literal(expression.left, not decisive):
        return expression.right
    if is_literal(expression.right, not decisive):
        return expression.left
    if is_literal(expression.right, decisive) and not may_fault(expression.left):
        return literal(decisive, BOOL, expression)
    return expression


def _without_neutral(expression: BinaryOperation) -> Expression:
    """The expression without ``* 1``, ``/ 1``, ``- 0`` and, for whole numbers, ``+ 0``, and ``-x`` for a real number
    ``x * -1``: exact for every value, including signed zeros and NaN.
    """
    left, right = expression.left, expression.right
    if not agrees(expression.type, left.type):
        return expression
    match expression:
        case BinaryOperation(operator="*", left=LiteralValue(value=one)) if _is_number(one, 1) and agrees(
            expression.type, right.type
        ):  # Not so in `1<ns> * n`, a time.
            return right
        case BinaryOperation(operator="*" | "/", right=LiteralValue(value=one)) if _is_number(one, 1):
            return left
        case BinaryOperation(operator="*", left=LiteralValue(value=float(one))) if one == -1 and agrees(
            expression.type, right.type
        ):
            return UnaryOperation(type=expression.type, span=expression.span, operator="-", operand=right)
        case BinaryOperation(operator="*" | "/", right=LiteralValue(value=float(one))) if one == -1:
            return UnaryOperation(type=expression.type, span=expression.span, operator="-", operand=left)
        case BinaryOperation(operator="-", right=LiteralValue(value=zero)) if _is_number(zero, 0):
            return left
        case BinaryOperation(operator="+", right=LiteralValue(value=int(zero))) if _is_number(zero, 0):
            return left
        case _:  # No other operand is neutral.
            return expression


def _is_number(value: object, number: int) -> bool:
    return isinstance(value, int | float) and value == number and math.copysign(1.0, value) > 0


def _evaluated(expression: Expression) -> Expression:
    match expression:
        case FunctionCall(function=function) if function in LIBRARY_FUNCTIONS:
            return expression
        case FunctionCall(function="seconds", arguments=(LiteralValue(value=int(time)),)) if abs(time) >= EXACT_SECONDS:
            return expression
        case BinaryOperation(operator="^") if isinstance(expression.type, RealType):
            return expression
    value = constant_value(expression, lambda _: None)
    if value is None or not fits(value, expression.type):
        return expression
    if isinstance(expression, FunctionCall) and expression.function in ("floor", "ceil") and value == 0:
        return expression  # The sign of this zero is that of the operand.
    return literal(value, expression.type, expression)


def fits(value: Any, kind: Type) -> bool:
    """Whether a value belongs to a type and is finite: infinities and NaN have no literal."""
    match kind:
        case BoolType():
            return isinstance(value, bool)
        case IntType():
            return type(value) is int and kind.minimum <= value <= kind.maximum
        case TimeType():
            return type(value) is int and -(2**63) <= value < 2**63
        case RealType():
            return isinstance(value, float) and math.isfinite(value)
        case EnumType():
            return type(value) is int
        case StructType():
            return all(fits(part, inner) for part, (_, inner) in zip(value, kind.fields, strict=True))
        case ArrayType():
            return all(fits(part, kind.element) for part in value)
        case TextType() | UnknownType():
            return False
        case _:
            assert_never(kind)
