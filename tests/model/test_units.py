"""Units: spelling, products, powers and conversions."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cspdiag.model.units import (
    DIMENSIONLESS,
    Unit,
    agree,
    canonical,
    conversion_factor,
    divide,
    multiply,
    parse_unit,
    power,
)


def unit(text: str) -> Unit:
    found = parse_unit(text)
    assert found is not None, text
    return found


SYMBOLS = [
    "m",
    "mm",
    "kg",
    "g",
    "s",
    "ms",
    "A",
    "K",
    "rad",
    "deg",
    "rev",
    "rpm",
    "Hz",
    "N",
    "V",
    "Ohm",
    "H",
    "min",
    "h",
]
units = st.lists(
    st.tuples(st.sampled_from(SYMBOLS), st.integers(1, 3), st.sampled_from("*/")), min_size=1, max_size=4
).map(lambda factors: unit("1" + "".join(f"{mark}{symbol}^{exponent}" for symbol, exponent, mark in factors)))


@pytest.mark.parametrize(
    ("left", "right"),
    [
        ("N", "kg*m/s^2"),
        ("V", "W/A"),
        ("Ohm", "V/A"),
        ("J", "N*m"),
        ("W", "V*A"),
        ("Hz", "1/s"),
        ("H", "V*s/A"),
        ("F", "A*s/V"),
        ("J/(kg*K)", "m^2/s^2/K"),
        ("mN", "g*m/s^2"),
        ("rev/min", "rpm"),
        ("m", "m^1"),
    ],
)
def test_spellings_of_one_unit_are_equal(left: str, right: str) -> None:
    assert unit(left) == unit(right)


@pytest.mark.parametrize(
    "text", ["", "Nm", "m/", "*m", "m**2", "(m", "m)", "m^", "m^x", "volt", "2*m", "m^99999", "m m"]
)
def test_texts_that_are_not_units(text: str) -> None:
    assert parse_unit(text) is None


def test_an_angle_is_a_number_in_expressions_but_not_on_a_port() -> None:
    assert agree(unit("rad"), DIMENSIONLESS)
    assert unit("rad") != DIMENSIONLESS
    assert agree(divide(unit("N*m"), unit("kg*m^2")), unit("rad/s^2"))
    assert not agree(unit("deg"), unit("rad"))


@pytest.mark.parametrize(
    ("source", "target", "factor"),
    [
        ("deg", "rad", math.pi / 180),
        ("rev", "rad", math.tau),
        ("rpm", "rad/s", math.pi / 30),
        ("km/h", "m/s", 5 / 18),
        ("mm", "m", 1e-3),
        ("min", "s", 60.0),
        ("V", "A", None),
    ],
)
def test_conversions_are_exact(source: str, target: str, factor: float | None) -> None:
    assert conversion_factor(unit(source), unit(target)) == factor


def test_products_are_spelled_as_an_engineer_would() -> None:
    assert str(divide(unit("V"), unit("A"))) == "V/A"
    assert str(multiply(unit("V*s/rad"), unit("rad/s"))) == "V"
    assert str(divide(unit("rad"), unit("s"))) == "rad/s"
    assert str(divide(DIMENSIONLESS, unit("s"))) == "1/s"
    assert str(power(unit("m/s"), 2)) == "m^2/s^2"


def test_roots_that_are_no_units() -> None:
    assert power(unit("m^2"), 1, 2) == unit("m")
    assert power(unit("mm^2"), 1, 2) == unit("mm")
    assert power(unit("m"), 1, 2) is None
    assert power(unit("cm"), 1, 2) is None


def test_canonical_units_are_coherent() -> None:
    assert canonical(unit("deg")) == "rad"
    assert canonical(unit("km/h")) == "m/s"
    assert canonical(unit("V")) == "V"


@given(units, units)
def test_division_undoes_multiplication(left: Unit, right: Unit) -> None:
    assert divide(multiply(left, right), right) == left


@given(units)
def test_a_square_is_a_product(found: Unit) -> None:
    assert power(found, 2) == multiply(found, found)


@given(units, st.sampled_from(SYMBOLS))
def test_a_printed_unit_that_can_be_read_is_the_same_unit(found: Unit, symbol: str) -> None:
    quotient = divide(found, unit(symbol))
    assert parse_unit(str(quotient)) in {quotient, None}
