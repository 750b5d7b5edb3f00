"""Checked integers and IEEE mathematics."""

from __future__ import annotations

import ctypes
import ctypes.util
import math
import struct
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cspdiag.runtime import Fault
from cspdiag.runtime.compiled import arithmetic

INT64 = st.integers(-(2**63), 2**63 - 1)


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [
        ("int8", -128, 127),
        ("int16", -(2**15), 2**15 - 1),
        ("int32", -(2**31), 2**31 - 1),
        ("int64", -(2**63), 2**63 - 1),
        ("uint8", 0, 255),
        ("uint16", 0, 65535),
        ("uint32", 0, 2**32 - 1),
    ],
)
def test_integers_keep_their_range(name: str, low: int, high: int) -> None:
    convert = getattr(arithmetic, name)
    assert convert(low) == low
    assert convert(high) == high
    assert type(convert(1.9)) is int
    assert convert(1.9) == 1
    for outside in (low - 1, high + 1, math.nan, math.inf, 1e300):
        with pytest.raises(Fault):
            convert(outside)


def test_reals_are_truncated_before_the_range_is_checked() -> None:
    assert arithmetic.int8(127.9) == 127
    assert arithmetic.int8(-128.9) == -128
    assert arithmetic.uint8(-0.9) == 0


@given(INT64, INT64)
def test_quotient_and_remainder_are_those_of_c(a: int, b: int) -> None:
    if b == 0:
        with pytest.raises(Fault):
            arithmetic.quotient(a, b)
        with pytest.raises(Fault):
            arithmetic.remainder(a, b)
        return
    quotient, remainder = arithmetic.quotient(a, b), arithmetic.remainder(a, b)
    assert quotient * b + remainder == a
    assert abs(remainder) < abs(b)
    assert remainder == 0 or (remainder < 0) == (a < 0)


def test_reals_divide_as_ieee() -> None:
    assert arithmetic.quotient(1.0, 0.0) == math.inf
    assert arithmetic.quotient(1.0, -0.0) == -math.inf
    assert math.isnan(arithmetic.quotient(0.0, 0.0))
    assert math.isnan(arithmetic.remainder(1.0, 0.0))
    assert arithmetic.remainder(-7.5, 2.0) == -1.5


@given(st.integers(-20, 20), st.integers(0, 70))
def test_integer_powers_are_exact_or_a_fault(base: int, exponent: int) -> None:
    if -(2**63) <= base**exponent < 2**63:
        assert arithmetic.power(base, exponent) == base**exponent
    else:
        with pytest.raises(Fault):
            arithmetic.power(base, exponent)


def test_huge_integer_powers_answer_at_once() -> None:
    assert arithmetic.power(-1, 10**18 + 1) == -1
    assert arithmetic.power(0, 10**18) == 0
    with pytest.raises(Fault):
        arithmetic.power(2, 10**18)
    with pytest.raises(Fault):
        arithmetic.power(2, -1)


_LIBM = ctypes.CDLL(ctypes.util.find_library("m") or "libm.so.6")


def _c(name: str, *arguments: float) -> float:
    function = getattr(_LIBM, name)
    function.restype = ctypes.c_double
    function.argtypes = [ctypes.c_double] * len(arguments)
    return float(function(*arguments))


def _same(a: float, b: float) -> bool:
    return struct.pack("<d", a) == struct.pack("<d", b) or (math.isnan(a) and math.isnan(b))


_ONE = {
    "exp": arithmetic.exp,
    "log": arithmetic.log,
    "sqrt": arithmetic.sqrt,
    "sin": arithmetic.sin,
    "cos": arithmetic.cos,
    "tan": arithmetic.tan,
    "floor": arithmetic.floor,
    "ceil": arithmetic.ceil,
    "round": arithmetic.nearest,
}
_TWO: dict[str, Callable[[float, float], Any]] = {
    "atan2": arithmetic.atan2,
    "pow": arithmetic.power,
    "fmod": arithmetic.remainder,
}


@given(st.floats() | st.integers(-100, 100).map(lambda n: n / 2) | st.sampled_from([0.49999999999999994, 2.0**52 + 1]))
def test_functions_of_one_real_are_those_of_c(x: float) -> None:
    for name, function in _ONE.items():
        assert _same(function(x), _c(name, x)), (name, x, function(x), _c(name, x))


@given(st.floats() | st.integers(-5, 5).map(float), st.floats() | st.integers(-5, 5).map(float))
def test_functions_of_two_reals_are_those_of_c(x: float, y: float) -> None:
    for name, function in _TWO.items():
        assert _same(function(x, y), _c(name, x, y)), (name, x, y, function(x, y), _c(name, x, y))


@given(st.floats())
def test_single_precision_is_that_of_c(x: float) -> None:
    assert _same(arithmetic.float32(x), ctypes.c_float(x).value)


def test_limit_sign_deadzone_and_quantize() -> None:
    assert [arithmetic.limit(x, -1.0, 1.0) for x in (-2.0, 0.5, 2.0)] == [-1.0, 0.5, 1.0]
    assert [arithmetic.sign(x) for x in (-2.0, 0.0, 3)] == [-1.0, 0.0, 1]
    assert [arithmetic.deadzone(x, 1.0) for x in (-3.0, -1.0, 0.5, 1.5)] == [-2.0, 0.0, 0.0, 0.5]
    assert [arithmetic.quantize(x, 0.25) for x in (0.1, 0.125, -0.125, 0.9)] == [0.0, 0.25, -0.25, 1.0]
    assert math.isnan(arithmetic.quantize(1.0, 0.0))
    assert all(math.isnan(f) for f in (arithmetic.limit(math.nan, 0.0, 1.0), arithmetic.deadzone(math.nan, 1.0)))


def test_elements_of_arrays() -> None:
    assert arithmetic.element((1, 2, 3), 2) == 3
    assert arithmetic.replaced((1, 2, 3), 9, 1) == (1, 9, 3)
    assert arithmetic.replaced(((1, 2), (3, 4)), 9, 1, 0) == ((1, 2), (9, 4))
    for index in (-1, 3):
        with pytest.raises(Fault, match=r"index -?\d is outside 0 .. 2"):
            arithmetic.element((1, 2, 3), index)
