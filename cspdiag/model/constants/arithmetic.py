"""Arithmetic on constants, with the same checks as at run time.

Integer division truncates toward zero and integers never wrap; doubles follow IEEE 754, but infinite results and NaN
are refused.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, assert_never

from cspdiag.model.constants.durations import in_seconds
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

if TYPE_CHECKING:
    from decimal import Decimal


class UndefinedError(Exception):
    """An operation has no result; the message is the reason."""


class OutOfRangeError(Exception):
    """A result does not fit its type; ``shown`` is the result."""

    def __init__(self, shown: str) -> None:
        super().__init__(shown)
        self.shown = shown


def checked(value: float, type_: Type) -> int | float:
    """The value, rounded to its type; raises OutOfRangeError or UndefinedError if it is not a value of the type."""
    match type_:
        case IntType() | TimeType():
            limits = type_ if isinstance(type_, IntType) else INT
            if not limits.minimum <= value <= limits.maximum:
                raise OutOfRangeError(_shown(value, type_))
            return int(value)
        case RealType():
            value = float(value)
            if math.isnan(value):
                raise UndefinedError("this is not a number")
            if type_.bits == 32:
                value = single(value)
            if math.isinf(value):
                raise OutOfRangeError("infinite")
            return value
        case BoolType() | TextType() | EnumType() | StructType() | ArrayType() | UnknownType():
            return value
        case _:
            assert_never(type_)


def _shown(value: float, type_: IntType | TimeType) -> str:
    """A number that is out of range."""
    if abs(value) < 10**40:
        return in_seconds(int(value)) if isinstance(type_, TimeType) else str(value)
    # Only messages need it, and it takes a hundredth of the start of `check` to load.
    from decimal import Decimal

    exact = Decimal(value)
    if exact.is_infinite():
        return "infinite"
    if not isinstance(type_, TimeType):
        return f"about {_rounded(exact)}"
    return f"about {_rounded(exact.scaleb(-9))} s"


def _rounded(value: Decimal) -> str:
    """Three digits of a large number: ``2e+60``."""
    digits, _, exponent = f"{value:.2e}".partition("e")
    return f"{digits.rstrip('0').rstrip('.')}e{exponent}"


def single(value: float) -> float:
    """The nearest binary32 number."""
    try:
        return float(struct.unpack("f", struct.pack("f", value))[0])
    except OverflowError:
        return math.copysign(math.inf, value)


def quotient(left: int, right: int) -> int:
    """Integer division that truncates toward zero."""
    result = abs(left) // abs(right)
    return result if (left < 0) == (right < 0) else -result


def remainder(left: int, right: int) -> int:
    """The remainder of truncating division, which has the sign of the dividend."""
    result = abs(left) % abs(right)
    return -result if left < 0 else result


def operate(operator: str, left: int | float, right: int | float, type_: Type) -> int | float:
    """``+ - * / % ^`` on two numbers of one type; raises UndefinedError or OutOfRangeError."""
    integers = isinstance(left, int) and isinstance(right, int)
    try:
        match operator:
            case "+":
                result: float = left + right
            case "-":
                result = left - right
            case "*":
                result = left * right
            case "/":
                if right == 0:
                    raise UndefinedError("this divides by zero")
                result = quotient(int(left), int(right)) if integers else left / right
            case "%":
                if right == 0:
                    raise UndefinedError("this divides by zero")
                result = remainder(int(left), int(right)) if integers else math.fmod(left, right)
            case "^":
                result = _power(left, right)
            case _:
                raise AssertionError(f"`{operator}` is not an operator on numbers")
    except OverflowError:
        raise OutOfRangeError("too large") from None
    return checked(result, type_)


def _power(base: int | float, exponent: int | float) -> int | float:
    if isinstance(base, int) and isinstance(exponent, int):
        if exponent < 0:
            raise UndefinedError("an integer has no negative power")
        if abs(base) > 1 and exponent * (abs(base).bit_length() - 1) > 64:
            raise OutOfRangeError("too large")
        return int(base**exponent)
    if base == 0 and exponent < 0:
        raise UndefinedError("this divides by zero")
    result = float(base) ** exponent
    if isinstance(result, complex):
        raise UndefinedError("a negative number has no fractional power")
    return float(result)


def _logarithm(value: float) -> float:
    if value <= 0:
        raise UndefinedError("only positive numbers have a logarithm")
    return math.log(value)


def _square_root(value: float) -> float:
    if value < 0:
        raise UndefinedError("a negative number has no square root")
    return math.sqrt(value)


def _of_a_sine(function: Callable[[float], float]) -> Callable[[float], float]:
    def angle(value: float) -> float:
        if not -1 <= value <= 1:
            raise UndefinedError("only numbers from -1 to 1 are the sine or cosine of an angle")
        return function(value)

    return angle


def _finite(value: float) -> float:
    if not math.isfinite(value):
        raise OutOfRangeError("too large")
    return value


def _sign(value: float) -> float:
    if isinstance(value, int):
        return (value > 0) - (value < 0)
    return 1.0 if value > 0 else -1.0 if value < 0 else value


def _half_away(value: float) -> float:
    """The nearest integer, with halves rounded away from zero."""
    if abs(value) >= 2**52:
        return value
    whole = math.floor(abs(value))
    return math.copysign(whole + (abs(value) - whole >= 0.5), value)


def _quantize(value: float, step: float) -> float:
    if step == 0:
        raise UndefinedError("there are no multiples of the step 0")
    return _half_away(value / step) * step


def _deadzone(value: float, width: float) -> float:
    return value - width if value > width else value + width if value < -width else 0.0


def _whole(function: Callable[[float], int]) -> Callable[[float], float]:
    """A rounding function whose zero results keep the sign of the argument, as in IEEE 754."""
    return lambda value: math.copysign(float(function(value)), value)


_FUNCTIONS: dict[str, Callable[..., float]] = {
    "abs": abs,
    "min": min,
    "max": max,
    "limit": lambda value, lowest, highest: lowest if value < lowest else highest if value > highest else value,
    "sign": _sign,
    "sqrt": _square_root,
    "exp": math.exp,
    "log": _logarithm,
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
    "asin": _of_a_sine(math.asin),
    "acos": _of_a_sine(math.acos),
    "atan": math.atan,
    "atan2": math.atan2,
    "floor": _whole(math.floor),
    "ceil": _whole(math.ceil),
    "round": _half_away,
    "quantize": _quantize,
    "deadzone": _deadzone,
    "finite": _finite,
}


def function(name: str, values: Sequence[int | float], type_: Type) -> int | float | None:
    """The value of a function of the language; None if it has no value before the program runs."""
    implementation = _FUNCTIONS.get(name)
    if implementation is None:
        return None
    try:
        return checked(implementation(*values), type_)
    except OverflowError:
        raise OutOfRangeError("too large") from None


def convert(value: bool | int | float, type_: IntType | RealType) -> int | float:
    """``int16(x)`` and the other conversions, which truncate toward zero; raises OutOfRangeError."""
    if isinstance(type_, RealType):
        return checked(float(value), type_)
    return checked(math.trunc(value), type_)
