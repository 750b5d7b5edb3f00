"""Values of expressions: the arithmetic of the language, written for clarity and not for speed."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Mapping
from typing import Any, assert_never

from cspdiag.model.types import (
    INT,
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
from cspdiag.network.ir import expressions as ex

Names = Callable[[str], Any]


class Cell:
    """A parameter of the program, or a constant that follows from some: all that use it see a change.
    «Parameters»
    """

    def __init__(self, value: Any) -> None:
        self.value = value


class RaisedError(Exception):
    """An exception of the language: it ends a process unless a handler around it catches it. «Exceptions»"""


class FaultError(RaisedError):
    """Overflow, a value out of range, division by zero, a value that is not a number. «Faults»"""


def value_of(
    expression: ex.Expression, parameters: Mapping[str, Any], variables: Names, signals: Names, time: float = 0.0
) -> Any:
    """The value of an expression; ``variables`` looks up channels of kind ``var``, and ``signals`` signals of control
    laws.

    «Expressions»

    Raises FaultError.
    """

    def inner(part: ex.Expression) -> Any:
        return value_of(part, parameters, variables, signals, time)

    match expression:
        case ex.LiteralValue():
            return fitting(expression.type, expression.value)
        case ex.ParameterValue():
            return parameters[expression.name]
        case ex.TunableValue():
            return parameters[expression.name].value
        case ex.VariableValue():
            return variables(expression.channel)
        case ex.SignalValue():
            return signals(expression.name)
        case ex.PresentTime():
            return time
        case ex.UnaryOperation():
            operand = inner(expression.operand)
            return fitting(expression.type, -operand) if expression.operator == "-" else not operand
        case ex.BinaryOperation(operator="and"):
            return inner(expression.left) and inner(expression.right)
        case ex.BinaryOperation(operator="or"):
            return inner(expression.left) or inner(expression.right)
        case ex.BinaryOperation():
            result = _binary(expression.operator, inner(expression.left), inner(expression.right))
            return fitting(expression.type, result)
        case ex.ConditionalValue():
            return inner(expression.then) if inner(expression.condition) else inner(expression.otherwise)
        case ex.FunctionCall():
            return fitting(expression.type, _function(expression.function, [inner(a) for a in expression.arguments]))
        case ex.Conversion():
            return _converted(expression.type, inner(expression.operand))
        case ex.FieldValue():
            assert isinstance(expression.operand.type, StructType)
            fields = [name for name, _ in expression.operand.type.fields]
            return inner(expression.operand)[fields.index(expression.field)]
        case ex.ElementValue():
            return inner(expression.operand)[within(inner(expression.index), inner(expression.operand))]
        case ex.StructValue() | ex.ArrayElements():
            return tuple(inner(part) for part in expression.values)
        case _:
            assert_never(expression)


def within(index: int, array: tuple[Any, ...]) -> int:
    """The index of an element, checked. Raises FaultError if it is out of range. «Faults»"""
    if not 0 <= index < len(array):
        raise FaultError(f"index {index} is outside 0 .. {len(array) - 1}")
    return index


def fitting(kind: Type, value: Any) -> Any:
    """A result as a value of its type: whole numbers are checked, binary32 is rounded. «Types and units», «Faults»"""
    match kind:
        case IntType():
            low, high = kind.minimum, kind.maximum
        case TimeType():
            low, high = -(2**63), 2**63 - 1
        case RealType():
            return _binary32(float(value)) if kind.bits == 32 else float(value)
        case BoolType() | TextType() | EnumType() | StructType() | ArrayType() | UnknownType():
            return value
        case _:
            assert_never(kind)
    if not low <= value <= high:
        raise _outside(value, kind, low, high)
    return value


def _outside(value: float, kind: Type, low: int, high: int) -> FaultError:
    value_text, low_text, high_text = (_shown(kind, number) for number in (value, low, high))
    return FaultError(f"{value_text} is outside {kind} ({low_text} .. {high_text})")


def _shown(kind: Type, value: float) -> str:
    """A number, or a time in seconds with all its digits."""
    if not isinstance(kind, TimeType):
        return str(value)
    seconds, nanoseconds = divmod(abs(int(value)), 10**9)
    fraction = f".{nanoseconds:09}".rstrip("0") if nanoseconds else ""
    return f"{'-' if value < 0 else ''}{seconds}{fraction} s"


def _binary32(value: float) -> float:
    try:
        return float(struct.unpack("f", struct.pack("f", value))[0])
    except OverflowError:
        return math.copysign(math.inf, value)


def _converted(kind: Type, value: Any) -> Any:
    if isinstance(kind, RealType):
        return fitting(kind, value)
    if isinstance(value, float) and not math.isfinite(value):
        raise FaultError(f"{value} is not in {kind}")
    whole = math.trunc(value)
    if isinstance(kind, IntType) and not kind.minimum <= whole <= kind.maximum:
        raise _outside(value, kind, kind.minimum, kind.maximum)
    return fitting(kind, whole)


def _binary(operator: str, left: Any, right: Any) -> Any:
    match operator:
        case "==":
            return left == right
        case "!=":
            return left != right
        case "<":
            return left < right
        case "<=":
            return left <= right
        case ">":
            return left > right
        case ">=":
            return left >= right
        case "+":
            return left + right
        case "-":
            return left - right
        case "*":
            return left * right
        case "^":
            return _power(left, right)
        case "/" | "%":
            return _divided(operator, left, right)
        case _:
            raise AssertionError(operator)


def _divided(operator: str, left: Any, right: Any) -> Any:
    if right == 0:
        raise FaultError("division by zero")
    if isinstance(left, float):
        return left / right if operator == "/" else (math.nan if math.isinf(left) else math.fmod(left, right))
    quotient = abs(left) // abs(right) * (1 if (left < 0) == (right < 0) else -1)
    return quotient if operator == "/" else left - quotient * right


def _power(base: Any, exponent: Any) -> Any:
    if isinstance(base, int):
        if exponent < 0:
            raise FaultError(f"negative exponent {exponent} of an integer")
        if abs(base) > 1 and exponent > 63:
            raise FaultError(f"{base} ^ {exponent} is outside int")
        return fitting(INT, base ** min(exponent, 64 + exponent % 2))
    try:
        return math.pow(base, exponent)
    except OverflowError:
        return -math.inf if base < 0 and exponent % 2 == 1 else math.inf
    except ValueError:
        if base == 0:
            return math.copysign(math.inf, base) if exponent % 2 == 1 else math.inf
        return math.nan


def _half_away_from_zero(x: float) -> float:
    if not math.isfinite(x) or abs(x) >= 2**52:
        return x
    # A half may not be added: 0.5 and the number below it make 1.
    whole = math.floor(abs(x))
    return math.copysign(whole + (abs(x) - whole >= 0.5), x)


def _function(function: str, arguments: list[Any]) -> Any:
    match function, arguments:
        case "abs", [x]:
            return abs(x)
        case "min", _:
            return min(arguments)
        case "max", _:
            return max(arguments)
        case "limit", [x, low, high]:
            return low if x < low else high if x > high else x
        case "sign", [x]:
            return type(x)(1) if x > 0 else type(x)(-1) if x < 0 else x
        case "finite", [x]:
            if not math.isfinite(x):
                raise FaultError("a real value is infinite or not a number")
            return x
        case "until", [instant, now]:
            return max(instant - now, 0)
        case "seconds", [x]:
            return x / 1e9
        case "atan2", [y, x]:
            return math.atan2(y, x)
        case "deadzone", [x, width]:
            return x - width if x > width else x + width if x < -width else x if x != x else type(x)(0)
        case "quantize", [x, step]:
            return step * _half_away_from_zero(x / step) if step else math.nan
        case "round", [x]:
            return _half_away_from_zero(x)
        case "floor" | "ceil", [x]:
            return x if not math.isfinite(x) else math.copysign(getattr(math, function)(x), x)
        case "log", [x]:
            return -math.inf if x == 0 else math.nan if x < 0 else math.log(x)
        case _, [x]:
            return _unary_function(function, x)
        case _:
            raise AssertionError(function)


def _unary_function(function: str, x: float) -> float:
    try:
        return float(getattr(math, function)(x))
    except OverflowError:
        return math.inf
    except ValueError:
        return math.nan


def zero(kind: Type) -> Any:
    """The value that an input of the environment has before the program writes: zero, false, the first literal.

    «The environment from instant to instant»
    """
    match kind:
        case BoolType():
            return False
        case RealType():
            return 0.0
        case ArrayType():
            return tuple(zero(kind.element) for _ in range(kind.size or 0))
        case StructType():
            return tuple(zero(field) for _, field in kind.fields)
        case IntType() | TimeType() | EnumType():
            return 0
        case _:
            raise AssertionError(kind)
