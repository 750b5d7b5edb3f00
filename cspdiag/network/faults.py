"""Which expressions can end a process with a ``Fault``; whoever drops or moves one has to ask."""

from __future__ import annotations

from typing import assert_never

from cspdiag.model.types import ArrayType, IntType, RealType
from cspdiag.network.expression_walk import walk
from cspdiag.network.expressions import (
    ArrayElements,
    BinaryOperation,
    ConditionalValue,
    Conversion,
    ElementValue,
    Expression,
    FieldValue,
    FunctionCall,
    LiteralValue,
    ParameterValue,
    PresentTime,
    SignalValue,
    StructValue,
    UnaryOperation,
    VariableValue,
)
from cspdiag.network.ranges import needs_check


def may_fault(expression: Expression) -> bool:
    """Whether evaluating the expression can fault.

    Overflow of whole numbers, division by zero (also of reals), conversions out of range and indexes out of range are faults, and so is the value of
    a variable that was not written, which is not looked at here: whoever moves an expression over a write of its variables has to know.
    """
    return any(map(_faults_itself, walk(expression)))


def variables_in(expression: Expression) -> frozenset[str]:
    """The variables that an expression reads."""
    return frozenset(part.channel for part in walk(expression) if isinstance(part, VariableValue))


def _faults_itself(part: Expression) -> bool:
    match part:
        case (
            LiteralValue()
            | ParameterValue()
            | VariableValue()
            | SignalValue()
            | PresentTime()
            | ConditionalValue()
            | FieldValue()
            | StructValue()
            | ArrayElements()
        ):
            return False
        case BinaryOperation(operator="/" | "%", right=LiteralValue(value=divisor)) if divisor != 0:
            return needs_check(part) and not isinstance(part.type, RealType)
        case BinaryOperation(operator="/" | "%"):
            return True
        case UnaryOperation() | BinaryOperation():
            return _is_whole(part) and needs_check(part)
        case FunctionCall(function="finite"):
            return True
        case FunctionCall(function="sign" | "seconds"):
            return False
        case FunctionCall():
            return _is_whole(part) and needs_check(part)
        case Conversion():
            return isinstance(part.type, IntType) and not _fits(part.operand, part.type)
        case ElementValue(operand=operand, index=index):
            return not (_known_size(operand) and _is_index(index, operand))
        case _:
            assert_never(part)


def _is_whole(part: Expression) -> bool:
    operators = ("==", "!=", "<", "<=", ">", ">=", "and", "or", "not")
    if isinstance(part, BinaryOperation | UnaryOperation) and part.operator in operators:
        return False
    return not isinstance(part.type, RealType)


def _fits(operand: Expression, kind: IntType) -> bool:
    given = operand.type
    return isinstance(given, IntType) and given.minimum >= kind.minimum and given.maximum <= kind.maximum


def _known_size(array: Expression) -> bool:
    return isinstance(array.type, ArrayType) and array.type.size is not None


def _is_index(index: Expression, array: Expression) -> bool:
    assert isinstance(array.type, ArrayType)
    return (
        isinstance(index, LiteralValue) and isinstance(index.value, int) and 0 <= index.value < (array.type.size or 0)
    )
