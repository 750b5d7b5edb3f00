"""Constants by value: arithmetic, overrides, and values written outside the program."""

from __future__ import annotations

import math

import pytest

from cspdiag.model.constants.values import parse_value
from cspdiag.model.program import Value
from cspdiag.model.types import BOOL, DOUBLE, INT, TIME, UNKNOWN, ArrayType, EnumType, IntType, RealType, Type
from cspdiag.model.units import parse_unit
from tests.model.programs import constant, correct


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1 + 2 * 3", 7),
        ("-7 / 2", -3),
        ("-7 % 3", -1),
        ("7 % -3", 1),
        ("7.0 / 2", 3.5),
        ("2 ^ 10", 1024),
        ("2 ^ (-1.0)", 0.5),
        ("1 / 2 + 0.25", 0.75),
        ("10 ms", 10_000_000),
        ("3 * 10 ms / 2", 15_000_000),
        ("10 ms / 3 ms", 3),
        ("10 ms % 3 ms", 1_000_000),
        ("2 kHz", 2000.0),
        ("double(5 ms)", 0.005),
        ("int16(-3.9)", -3),
        ("round(2.5)", 3.0),
        ("round(-2.5)", -3.0),
        ("quantize(0.74, 0.5)", 0.5),
        ("deadzone(-0.5, 0.2)", -0.3),
        ("limit(5, -1, 1)", 1),
        ("max(1, 2.5)", 2.5),
        ("sign(-3)", -1),
        ("atan2(1.0, 1.0)", math.pi / 4),
        ("cos(pi)", -1.0),
        ("convert(180<deg>, rad)", math.pi),
        ("convert(36<km/h>, m/s)", 10.0),
        ("if 1 < 2 then 3 else 4", 3),
        ("1 == 2 or not false and 2 <= 2", True),
        ("[1, 2.5][0]", 1.0),
        ("float(0.1)", 0.10000000149011612),
        ("sqrt(9<m^2>)", 3.0),
        ("-9223372036854775808", -(2**63)),
    ],
)
def test_value_of_an_expression(text: str, value: Value) -> None:
    found = constant(correct(f"const x = {text}\n"), "x")
    assert found == value
    assert type(found) is type(value)


def test_a_conjunction_is_decided_from_the_left() -> None:
    program = correct("const n = 0\nconst x = n != 0 and n > 1\nconst y = if n == 0 then 1 else 10 % n\n")
    assert constant(program, "x") is False
    assert constant(program, "y") == 1


def test_structs_and_enums_are_values() -> None:
    program = correct(
        """
        enum Mode { idle, run }
        struct Setting { gain: double  mode: Mode  limits: int[2] }
        const setting = Setting(2, limits = [1, 2], mode = Mode.run)
        const last = setting.limits[1]
        """
    )
    assert constant(program, "setting") == (2.0, 1, (1, 2))
    assert constant(program, "last") == 2


def test_an_override_affects_everything_computed_from_it() -> None:
    text = "const T = 1 ms\nconst slow = 10 * T\nconst n = 4\nconst x: int[n] = [1, 2]\n"
    program = correct(text, {"T": "2 ms", "n": 2})
    assert constant(program, "T") == 2_000_000
    assert constant(program, "slow") == 20_000_000
    assert constant(program, "x") == (1, 2)


RADIAN = RealType(unit=parse_unit("rad") or DOUBLE.unit)


@pytest.mark.parametrize(
    ("type_", "text", "value"),
    [
        (TIME, "10ms", 10_000_000),
        (TIME, " 0.5 s ", 500_000_000),
        (TIME, "1kHz", 1_000_000),
        (INT, "-12", -12),
        (DOUBLE, "2e-3", 0.002),
        (DOUBLE, "3", 3.0),
        (RADIAN, "0.5", 0.5),
        (RADIAN, "0.5<rad>", 0.5),
        (RADIAN, "180 deg", math.pi),
        (BOOL, "true", True),
        (EnumType("Mode", ("idle", "run")), "Mode.run", 1),
        (EnumType("Mode", ("idle", "run")), "idle", 0),
        (ArrayType(DOUBLE, 2), "[1, 2.5]", (1.0, 2.5)),
    ],
)
def test_a_value_given_outside_the_program(type_: Type, text: str, value: Value) -> None:
    found = parse_value(type_, text)
    assert found == value
    assert type(found) is type(value)


@pytest.mark.parametrize(
    ("type_", "text", "reason"),
    [
        (TIME, "10", "write it with a unit"),
        (TIME, "fast", "not a time"),
        (TIME, "0Hz", "not a time"),
        (TIME, "1e300s", "does not fit"),
        (INT, "1.5", "not of type int"),
        (IntType(8), "200", "does not fit"),
        (DOUBLE, "1e999", "does not fit"),
        (DOUBLE, "1<V>", "units do not agree"),
        (RADIAN, "1<volt>", "not a unit"),
        (BOOL, "1", "neither true nor false"),
        (EnumType("Mode", ("idle", "run")), "walk", "not one of idle, run"),
        (ArrayType(DOUBLE, 2), "[1]", "one element, not 2"),
        (ArrayType(DOUBLE, 2), "1, 2", "write it as"),
        (UNKNOWN, "1", "not known"),
    ],
)
def test_an_invalid_value_is_refused_with_a_reason(type_: Type, text: str, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        parse_value(type_, text)
