"""Values of expressions that depend on constants and parameters only, for coefficients and sizes.

Arithmetic is that of the language: ``/`` on integers truncates toward zero, ``%`` takes the sign of the dividend.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from typing import Any, assert_never

from cspdiag.model.types import IntType, RealType, StructType, TimeType
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
    Value,
    VariableValue,
)

Lookup = Callable[[ParameterValue | SignalValue], "Value | None"]


def constant_value(expression: Expression, lookup: Lookup) -> Value | None:
    """The value of an expression, None where a name has no value yet or the arithmetic fails.

    ``lookup`` gives the values of parameters and of constants of the submodel.
    """
    try:
        value: Value = _value(expression, lookup)
        return value
    except (ArithmeticError, ValueError, TypeError, IndexError, _NoValueError):
        return None


class _NoValueError(Exception):
    pass


def _value(expression: Expression, lookup: Lookup) -> Any:
    def value(part: Expression) -> Any:
        return _value(part, lookup)

    match expression:
        case LiteralValue():
            return expression.value
        case ParameterValue() | SignalValue():
            found = lookup(expression)
            if found is None:
                raise _NoValueError
            return found
        case VariableValue() | PresentTime():
            raise _NoValueError
        case UnaryOperation():
            operand = value(expression.operand)
            return -operand if expression.operator == "-" else not operand
        case BinaryOperation():
            return _binary(expression, lookup)
        case ConditionalValue():
            return value(expression.then if value(expression.condition) else expression.otherwise)
        case FunctionCall():
            return _function(expression.function, *map(value, expression.arguments))
        case Conversion():
            operand = value(expression.operand)
            return float(operand) if isinstance(expression.type, RealType) else int(operand)
        case FieldValue():
            assert isinstance(expression.operand.type, StructType)
            names = [name for name, _ in expression.operand.type.fields]
            return value(expression.operand)[names.index(expression.field)]
        case ElementValue():
            index = value(expression.index)
            if index < 0:
                raise _NoValueError
            return value(expression.operand)[index]
        case StructValue() | ArrayElements():
            return tuple(map(value, expression.values))
        case _:
            assert_never(expression)


def _binary(expression: BinaryOperation, lookup: Lookup) -> Any:
    left = _value(expression.left, lookup)
    if expression.operator in ("and", "or"):
        decided = left == (expression.operator == "or")
        return left if decided else _value(expression.right, lookup)
    whole = isinstance(expression.left.type, IntType | TimeType) and isinstance(left, int)
    return _operation(expression.operator, left, _value(expression.right, lookup), whole)


def _operation(name: str, left: Any, right: Any, whole: bool) -> Any:
    if name == "/" and whole:
        quotient = abs(left) // abs(right)
        return quotient if (left < 0) == (right < 0) else -quotient
    if name == "%":
        return left - right * _operation("/", left, right, True) if whole else math.fmod(left, right)
    if name == "^":
        if whole and (right < 0 or abs(left).bit_length() * right > 64):
            raise OverflowError
        return left**right
    return _OPERATIONS[name](left, right)


_OPERATIONS: dict[str, Callable[[Any, Any], Any]] = {
    "+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv,
    "==": operator.eq, "!=": operator.ne, "<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge,
}  # fmt: skip


def _function(name: str, *arguments: Any) -> Any:
    x = arguments[0]
    match name:
        case "seconds":
            return x / 1_000_000_000
        case "abs":
            return abs(x)
        case "min":
            return min(arguments)
        case "max":
            return max(arguments)
        case "limit":
            return min(max(x, arguments[1]), arguments[2])
        case "sign":
            return type(x)((x > 0) - (x < 0))
        case "floor":
            return float(math.floor(x))
        case "ceil":
            return float(math.ceil(x))
        case "round":
            return _rounded(x)
        case "quantize":
            return arguments[1] * _rounded(x / arguments[1])
        case "deadzone":
            return math.copysign(max(abs(x) - arguments[1], 0.0), x)
        case _:
            return getattr(math, name)(*arguments)


def _rounded(x: float) -> float:
    """The nearest whole number, halves away from zero."""
    whole = math.floor(abs(x))
    return math.copysign(whole + (abs(x) - whole >= 0.5), x)
