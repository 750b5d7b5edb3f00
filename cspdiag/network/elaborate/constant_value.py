"""Values of expressions that depend on constants and parameters only, for coefficients and sizes."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any, assert_never

from cspdiag.model.constants import arithmetic
from cspdiag.model.types import UNKNOWN, IntType, RealType, StructType
from cspdiag.network.ir.expressions import (
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
    TunableValue,
    UnaryOperation,
    Value,
    VariableValue,
)

Lookup = Callable[[ParameterValue | SignalValue], "Value | None"]


def constant_value(expression: Expression, lookup: Lookup) -> Value | None:
    """The value of an expression; None if a name has no value yet or the arithmetic fails.

    ``lookup`` returns the values of parameters and of constants of the submodel.
    """
    try:
        return computed_value(expression, lookup)
    except (
        NoValueError,
        NoElementError,
        arithmetic.UndefinedError,
        arithmetic.OutOfRangeError,
        ArithmeticError,
        ValueError,
    ):
        return None


class NoValueError(Exception):
    """A name has no value yet."""


class NoElementError(Exception):
    """An index is outside of an array with ``size`` elements."""

    def __init__(self, index: int, size: int) -> None:
        super().__init__(index, size)
        self.index = index
        self.size = size


def computed_value(expression: Expression, lookup: Lookup) -> Value:
    """The value of an expression. Raises NoValueError if a name has no value, and NoElementError, UndefinedError or
    OutOfRangeError if the arithmetic fails.
    """
    value: Value = _value(expression, lookup)
    return value


def _value(expression: Expression, lookup: Lookup) -> Any:
    def value(part: Expression) -> Any:
        return _value(part, lookup)

    match expression:
        case LiteralValue():
            if expression.type == UNKNOWN:
                raise NoValueError
            return expression.value
        case ParameterValue() | SignalValue():
            found = lookup(expression)
            if found is None:
                raise NoValueError
            return found
        case TunableValue() | VariableValue() | PresentTime():
            raise NoValueError
        case UnaryOperation():
            operand = value(expression.operand)
            return arithmetic.checked(-operand, expression.type) if expression.operator == "-" else not operand
        case BinaryOperation():
            return _binary(expression, lookup)
        case ConditionalValue():
            return value(expression.then if value(expression.condition) else expression.otherwise)
        case FunctionCall():
            arguments = [value(argument) for argument in expression.arguments]
            if expression.function == "seconds":
                return arithmetic.checked(arguments[0] / 1_000_000_000, expression.type)
            return arithmetic.function(expression.function, arguments, expression.type)
        case Conversion():
            assert isinstance(expression.type, IntType | RealType)
            return arithmetic.convert(value(expression.operand), expression.type)
        case FieldValue():
            if not isinstance(expression.operand.type, StructType):
                raise NoValueError  # The constant was refused, and has no type.
            names = [name for name, _ in expression.operand.type.fields]
            return value(expression.operand)[names.index(expression.field)]
        case ElementValue():
            index = value(expression.index)
            elements = value(expression.operand)
            if not 0 <= index < len(elements):
                raise NoElementError(index, len(elements))
            return elements[index]
        case StructValue() | ArrayElements():
            return tuple(map(value, expression.values))
        case _:
            assert_never(expression)


def _binary(expression: BinaryOperation, lookup: Lookup) -> Any:
    left = _value(expression.left, lookup)
    match expression.operator:
        case "and" | "or":
            decided = left == (expression.operator == "or")
            return left if decided else _value(expression.right, lookup)
        case "==" | "!=" | "<" | "<=" | ">" | ">=":
            return _COMPARISONS[expression.operator](left, _value(expression.right, lookup))
        case "+" | "-" | "*" | "/" | "%" | "^":
            return arithmetic.operate(expression.operator, left, _value(expression.right, lookup), expression.type)
        case _:
            assert_never(expression.operator)


_COMPARISONS: dict[str, Callable[[Any, Any], bool]] = {
    "==": operator.eq, "!=": operator.ne, "<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge,
}  # fmt: skip
