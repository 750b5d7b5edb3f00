"""Expressions of the text become expressions of the network."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cspdiag.network.ir.equations import SubmodelEquation
from cspdiag.network.ir.expression_walk import signals_read, walk
from cspdiag.network.ir.expressions import Expression, FunctionCall, LiteralValue
from tests.network.submodels.compiled import MS, instance, submodel


def lowered(
    text: str, parameters: str = "", inputs: str = "in x : double", kind: str = "double", **values: Any
) -> Expression:
    cls, _ = submodel(f"submodel Law{parameters} {{ {inputs} out y : {kind} y = {text} }}", "Law", values)
    (equation,) = [item for item in cls.equations if item.name == "y"]
    assert isinstance(equation, SubmodelEquation)
    return equation.value


def test_numbers_take_the_type_of_their_surroundings() -> None:
    assert [part.value for part in walk(lowered("x * 2 + 1")) if isinstance(part, LiteralValue)] == [2.0, 1.0]
    number = lowered("2", kind="int8")
    assert isinstance(number, LiteralValue)
    assert isinstance(number.value, int)


def test_a_minus_belongs_to_the_number() -> None:
    number = lowered("-2.5")
    assert isinstance(number, LiteralValue)
    assert number.value == -2.5


def test_durations_in_equations_are_seconds() -> None:
    assert [part.value for part in walk(lowered("x * 5 ms / 1<s>")) if isinstance(part, LiteralValue)] == [0.005, 1.0]


def test_a_time_parameter_is_turned_into_seconds() -> None:
    found = lowered("x * (tau / 1<s>)", "(tau: time)", tau=20 * MS)
    assert [part.function for part in walk(found) if isinstance(part, FunctionCall)] == ["finite", "seconds"]


def test_conversions_of_numbers_are_done_at_compile_time() -> None:
    found = lowered("convert(180<deg>, rad)", kind="double<rad>")
    assert isinstance(found, LiteralValue)
    assert found.value == math.pi


def test_a_conversion_to_the_same_scale_leaves_nothing() -> None:
    found = lowered("convert(x, N*m)", inputs="in x : double<J>", kind="double<N*m>")
    assert signals_read(found) == ["x"]
    assert len(list(walk(found))) == 1


def test_every_part_keeps_its_place() -> None:
    assert all(part.span is not None for part in walk(lowered("if x > 1 then -sqrt(x) else max(x, 2, 3)")))


numbers = st.floats(-1e3, 1e3, allow_subnormal=False).map(lambda x: round(x, 3))
leaves = st.one_of(st.just("x"), st.just("z"), numbers.map(lambda v: f"({v!r})" if "e" not in repr(v) else "0.5"))
formulas = st.recursive(
    leaves,
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from(["+", "-", "*"]), inner).map(lambda t: f"({t[0]} {t[1]} {t[2]})"),
        inner.map(lambda a: f"sin({a})"),
        inner.map(lambda a: f"abs(-{a})"),
        st.tuples(inner, inner, inner).map(lambda t: f"limit({t[0]}, -abs({t[1]}), abs({t[2]}))"),
        st.tuples(inner, inner, inner).map(lambda t: f"(if {t[0]} < {t[1]} then {t[1]} else {t[2]})"),
    ),
    max_leaves=12,
)


@settings(max_examples=60, deadline=None)
@given(formulas, numbers, numbers)
def test_formulas_have_their_arithmetic_meaning(formula: str, x: float, z: float) -> None:
    law = instance(f"submodel Law {{ in x : double in z : double out y : double y = x * 0 + {formula} }}", "Law")
    assert law.evaluate(x=x, z=z)["y"] == pytest.approx(meaning(formula, x, z), nan_ok=True)


def meaning(formula: str, x: float, z: float) -> float:
    """Evaluates the text of a formula in Python, with choices turned into calls."""
    text = formula.replace("(if ", "choose(lambda: ").replace(" then ", ", lambda: ").replace(" else ", ", lambda: ")
    names = {
        "x": x,
        "z": z,
        "sin": math.sin,
        "abs": abs,
        "limit": lambda v, low, high: low if v < low else min(v, high),
        "choose": lambda test, then, otherwise: then() if test() else otherwise(),
    }
    return float(eval(text, names))
