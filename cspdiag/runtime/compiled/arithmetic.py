"""Checked integers, and IEEE 754 mathematics without Python's exceptions.

Integers that leave their range are a ``Fault``, never a silent wrap. Functions of reals return a NaN or an infinity
where IEEE 754 and C's ``libm`` do.

Agreement with C: ``sqrt``, ``floor``, ``ceil``, ``nearest``, ``limit``, ``sign``, ``deadzone``, ``float32`` and
``remainder`` are exact, and the same bits everywhere. ``exp log sin cos tan asin acos atan atan2 power`` are those of
the platform's ``libm``, which C calls too: the same bits on the same platform, but the last digit may differ between
platforms. ``quantize`` differs only if its argument does.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Sequence
from typing import Any, TypeVar, overload

from ..kernel.exceptions import Fault

T = TypeVar("T")
N = TypeVar("N", int, float)

INFINITY = math.inf
NOT_A_NUMBER = math.nan


def _integer_type(name: str, low: int, high: int) -> Callable[[float], int]:
    def convert(value: float) -> int:
        if not low <= value <= high:
            whole = _whole(name, value)
            if not low <= whole <= high:
                raise Fault(f"{value} is outside {name} ({low} .. {high})")
            return whole
        return int(value)

    convert.__name__ = convert.__qualname__ = name
    convert.__doc__ = f"To {name}: reals are truncated toward zero. Raises Fault outside {low} .. {high}."
    return convert


def _whole(name: str, value: float) -> int:
    if not isinstance(value, int) and not math.isfinite(value):
        raise Fault(f"{value} is not in {name}")
    return int(value)


int8 = _integer_type("int8", -(2**7), 2**7 - 1)
int16 = _integer_type("int16", -(2**15), 2**15 - 1)
int32 = _integer_type("int32", -(2**31), 2**31 - 1)
int64 = _integer_type("int", -(2**63), 2**63 - 1)
uint8 = _integer_type("uint8", 0, 2**8 - 1)
uint16 = _integer_type("uint16", 0, 2**16 - 1)
uint32 = _integer_type("uint32", 0, 2**32 - 1)


def duration(nanoseconds: float) -> int:
    """A ``time``: reals are truncated toward zero. Raises Fault for one that 64 bits of nanoseconds cannot hold."""
    if not -(2**63) <= nanoseconds < 2**63:
        whole = _whole("time", nanoseconds)
        raise Fault(f"{_in_seconds(whole)} is outside time ({_in_seconds(-(2**63))} .. {_in_seconds(2**63 - 1)})")
    return int(nanoseconds)


def _in_seconds(nanoseconds: int) -> str:
    """All digits: ``-1.5 s``."""
    whole, rest = divmod(abs(nanoseconds), 10**9)
    fraction = f".{rest:09}".rstrip("0") if rest else ""
    return f"{'-' if nanoseconds < 0 else ''}{whole}{fraction} s"


_SINGLE = struct.Struct("<f")


def float32(value: float) -> float:
    """Rounded to the nearest IEEE binary32, ties to even; too large values become infinite."""
    try:
        return float(_SINGLE.unpack(_SINGLE.pack(value))[0])
    except OverflowError:
        return math.copysign(INFINITY, value)


@overload
def quotient(dividend: int, divisor: int) -> int: ...
@overload
def quotient(dividend: float, divisor: float) -> float: ...
def quotient(dividend: float, divisor: float) -> float:
    """Division: of integers truncated toward zero, of reals as IEEE. Raises Fault for an integer divided by zero."""
    if isinstance(dividend, int) and isinstance(divisor, int):
        if divisor == 0:
            raise Fault("division by zero")
        magnitude = abs(dividend) // abs(divisor)
        return magnitude if (dividend < 0) == (divisor < 0) else -magnitude
    if divisor == 0:
        if dividend == 0 or dividend != dividend:
            return NOT_A_NUMBER
        return math.copysign(INFINITY, dividend) * math.copysign(1.0, divisor)
    return dividend / divisor


@overload
def remainder(dividend: int, divisor: int) -> int: ...
@overload
def remainder(dividend: float, divisor: float) -> float: ...
def remainder(dividend: float, divisor: float) -> float:
    """Remainder with the sign of the dividend. Raises Fault for an integer and zero; of reals as C's ``fmod``."""
    if isinstance(dividend, int) and isinstance(divisor, int):
        if divisor == 0:
            raise Fault("division by zero")
        magnitude = abs(dividend) % abs(divisor)
        return magnitude if dividend >= 0 else -magnitude
    try:
        return math.fmod(dividend, divisor)
    except ValueError:
        return NOT_A_NUMBER


@overload
def power(base: int, exponent: int) -> int: ...
@overload
def power(base: float, exponent: float) -> float: ...
def power(base: float, exponent: float) -> float:
    """Base to the exponent: of integers exact (Fault beyond 64 bits or for a negative exponent), of reals as C's
    ``pow``.
    """
    if isinstance(base, int) and isinstance(exponent, int):
        return _integer_power(base, exponent)
    try:
        return math.pow(base, exponent)
    except OverflowError:
        return -INFINITY if base < 0 and exponent % 2 == 1 else INFINITY
    except ValueError:
        if base == 0:  # a negative exponent: a pole, signed for odd integers
            return math.copysign(INFINITY, base) if exponent % 2 == 1 else INFINITY
        return NOT_A_NUMBER


def _integer_power(base: int, exponent: int) -> int:
    if exponent < 0:
        raise Fault(f"negative exponent {exponent} of an integer")
    if abs(base) > 1 and exponent > 63:
        raise Fault(f"{base} ^ {exponent} is outside int")
    # Powers of -1, 0 and 1 depend on whether the exponent is 0, odd or even: huge ones need not be multiplied out.
    return int64(base ** min(exponent, 64 + exponent % 2))


def exp(x: float) -> float:
    """e to the x; infinite on overflow."""
    try:
        return math.exp(x)
    except OverflowError:
        return INFINITY


def log(x: float) -> float:
    """Natural logarithm; -infinity at 0, NaN below."""
    if x > 0:
        return math.log(x)
    return -INFINITY if x == 0 else NOT_A_NUMBER


def sqrt(x: float) -> float:
    """Square root; NaN below 0."""
    try:
        return math.sqrt(x)
    except ValueError:
        return NOT_A_NUMBER


def finite(x: float) -> float:
    """``x``. Raises Fault for an infinity or a NaN: every real value of a program is a number."""
    if x - x != 0.0:
        raise Fault("a real value is infinite or not a number")
    return x


def sin(x: float) -> float:
    """Sine; NaN at infinity."""
    try:
        return math.sin(x)
    except ValueError:
        return NOT_A_NUMBER


def cos(x: float) -> float:
    """Cosine; NaN at infinity."""
    try:
        return math.cos(x)
    except ValueError:
        return NOT_A_NUMBER


def tan(x: float) -> float:
    """Tangent; NaN at infinity."""
    try:
        return math.tan(x)
    except ValueError:
        return NOT_A_NUMBER


def asin(x: float) -> float:
    """The angle of a sine; NaN outside -1 .. 1."""
    return math.asin(x) if -1.0 <= x <= 1.0 else NOT_A_NUMBER


def acos(x: float) -> float:
    """The angle of a cosine; NaN outside -1 .. 1."""
    return math.acos(x) if -1.0 <= x <= 1.0 else NOT_A_NUMBER


def atan(x: float) -> float:
    """The angle of a slope, in -pi/2 .. pi/2."""
    return math.atan(x)


def atan2(y: float, x: float) -> float:
    """Angle of the point (x, y) in -pi .. pi."""
    return math.atan2(y, x)


def floor(x: float) -> float:
    """The largest whole number not above x."""
    return float(math.floor(x)) if math.isfinite(x) and x != 0 else x


def ceil(x: float) -> float:
    """The smallest whole number not below x."""
    if not math.isfinite(x) or x == 0:
        return x
    return math.copysign(float(math.ceil(x)), x)


def nearest(x: float) -> float:
    """The nearest whole number, halves away from zero, as C's ``round``."""
    fraction, whole = math.modf(x)  # exact
    return whole + 1.0 if fraction >= 0.5 else whole - 1.0 if fraction <= -0.5 else whole


def limit(x: N, low: N, high: N) -> N:
    """``x``, but not below ``low`` and not above ``high``; a NaN passes."""
    return low if x < low else high if x > high else x


def sign(x: N) -> N:
    """-1, 0 or 1, of the type of ``x``; a NaN passes."""
    if isinstance(x, int):
        return (x > 0) - (x < 0)
    return 1.0 if x > 0 else -1.0 if x < 0 else x


def quantize(x: float, step: float) -> float:
    """The nearest multiple of ``step``, halves away from zero; a NaN for step 0, as IEEE."""
    return nearest(x / step) * step if step else NOT_A_NUMBER


def deadzone(x: float, width: float) -> float:
    """0 within ``width`` of 0, and beyond it ``x`` less the width."""
    return x - width if x > width else x + width if x < -width else x if x != x else 0.0


def element(array: Sequence[T], index: int) -> T:
    """An element. Raises Fault for an index out of range, such as a negative one."""
    if not 0 <= index < len(array):
        raise Fault(f"index {index} is outside 0 .. {len(array) - 1}")
    return array[index]


def replaced(array: Sequence[Any], value: Any, index: int, *inner: int) -> tuple[Any, ...]:
    """A copy with one element changed; further indexes are those in arrays of arrays. Raises Fault for an index out of
    range.
    """
    old = element(array, index)
    new = replaced(old, value, *inner) if inner else value
    return (*array[:index], new, *array[index + 1 :])
