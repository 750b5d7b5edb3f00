"""Arithmetic in C has the results that it has in Python, faults included: the same bits and the same messages."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from cspdiag.runtime.compiled import arithmetic
from cspdiag.runtime.kernel.exceptions import Fault
from tests.codegen.c.arithmetic_library import Arithmetic, compilers

LOW, HIGH = -(2**63), 2**63 - 1

words = st.one_of(
    st.integers(LOW, HIGH), st.integers(-300, 300), st.sampled_from([LOW, LOW + 1, HIGH, HIGH - 1, 2**31, 2**32])
)
reals = st.one_of(
    st.floats(),
    st.sampled_from([0.0, -0.0, 0.5, -0.5, 1.5, 2.5, math.inf, -math.inf, math.nan, 2.0**53, 1e308, 5e-324]),
)


@pytest.fixture(scope="module", params=compilers() or [""])
def library(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Arithmetic:
    if not request.param:
        pytest.skip("there is no C compiler")
    folder: Path = tmp_path_factory.mktemp("arithmetic")
    return Arithmetic(folder, request.param)


def outcome(evaluate: Callable[[], object]) -> tuple[object, str]:
    """The value, or the message of the fault."""
    try:
        return evaluate(), ""
    except Fault as fault:
        return None, str(fault)
    except ZeroDivisionError:
        return None, "division by zero"


def same(library: Arithmetic, found: object, expected: tuple[object, str]) -> None:
    value, words = expected
    assert library.fault() == words
    if not words:
        assert found == value or (found != found and value != value)
        if isinstance(found, float) and found == found:
            assert struct.pack("d", found) == struct.pack("d", value)


@settings(max_examples=400, deadline=None)
@given(words, words)
@example(LOW, -1)
@example(-2, 63)
@example(-2, 64)
@example(3, 40)
@example(-7, 63)
@example(HIGH, 63)
@example(LOW, 63)
@example(-1, HIGH)
@example(0, 0)
def test_whole_numbers(library: Arithmetic, left: int, right: int) -> None:
    checked = arithmetic.int64
    operations: dict[str, Callable[[], object]] = {
        "add": lambda: checked(left + right),
        "subtract": lambda: checked(left - right),
        "multiply": lambda: checked(left * right),
        "quotient": lambda: checked(arithmetic.quotient(left, right)),
        "remainder": lambda: arithmetic.remainder(left, right),
        "power": lambda: arithmetic.power(left, right),
        "min_int": lambda: min(left, right),
        "max_int": lambda: max(left, right),
    }
    for name, evaluate in operations.items():
        same(library, library.whole(name)(left, right), outcome(evaluate))
    same(library, library.whole("negate")(left), outcome(lambda: checked(-left)))
    same(library, library.whole("absolute")(left), outcome(lambda: checked(abs(left))))
    same(library, library.whole("sign_int")(left), outcome(lambda: arithmetic.sign(left)))


@settings(max_examples=200, deadline=None)
@given(words, reals)
@example(128, 127.9)
@example(0, -0.5)
@example(0, -1.0)
@example(0, 255.99999999999997)
@example(0, 9.223372036854776e18)
@example(0, -9.223372036854776e18)
@example(0, 123456.0)
@example(0, 1e16)
@example(0, 1.5e300)
@example(0, -0.00012)
def test_conversions(library: Arithmetic, whole: int, real: float) -> None:
    for name in ("int8", "int16", "int32", "uint8", "uint16", "uint32"):
        convert = getattr(arithmetic, name)
        same(library, library.whole(name)(whole), outcome(partial(convert, whole)))
        same(library, library.whole_of_real(f"{name}_of_real")(real), outcome(partial(convert, real)))
    same(library, library.whole_of_real("int64_of_real")(real), outcome(lambda: arithmetic.int64(real)))


@settings(max_examples=400, deadline=None)
@given(reals, reals, reals)
def test_reals(library: Arithmetic, x: float, y: float, z: float) -> None:
    same(library, library.real("divide")(x, y), outcome(lambda: x / y))
    of_two: dict[str, Callable[[float, float], object]] = {
        "min": min,
        "max": max,
        "pow": arithmetic.power,
        "atan2": arithmetic.atan2,
        "fmod": arithmetic.remainder,
        "quantize": arithmetic.quantize,
        "deadzone": arithmetic.deadzone,
    }
    for name, function in of_two.items():
        same(library, library.real(name)(x, y), outcome(partial(function, x, y)))
    for name in ("exp", "log", "sin", "cos", "tan", "sign", "floor", "ceil", "sqrt"):
        function = getattr(arithmetic, name)
        same(library, library.real(name)(x), outcome(partial(function, x)))
    same(library, library.real("round")(x), outcome(lambda: arithmetic.nearest(x)))
    same(library, library.real("limit")(x, y, z), outcome(lambda: arithmetic.limit(x, y, z)))


@settings(max_examples=300, deadline=None)
@given(words)
@example(2**53 + 1)
@example(9_007_199_254_740_993_000)
def test_seconds_are_rounded_once(library: Arithmetic, nanoseconds: int) -> None:
    same(library, library.real_of_whole("seconds")(nanoseconds), (nanoseconds / 1_000_000_000, ""))


@given(words, st.integers(1, 100))
def test_elements(library: Arithmetic, index: int, size: int) -> None:
    same(library, library.whole("index")(index, size), outcome(lambda: arithmetic.element(range(size), index)))


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_what_is_written_must_be_finite(library: Arithmetic, value: float) -> None:
    library.real("finite")(value)
    assert library.fault() == f"{value} is written to port"
    library.real("finite")(1e308)
    assert library.fault() == ""


def test_the_first_fault_counts(library: Arithmetic) -> None:
    library.whole("quotient")(1, 0)
    library.whole("int8")(300)
    assert library.fault() == "division by zero"
