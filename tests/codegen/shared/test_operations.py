"""Decisions about operations that both languages adopt."""

from __future__ import annotations

import pytest

from cspdiag.codegen.python.plain.expressions import Printer
from cspdiag.codegen.python.text.code import Name
from cspdiag.codegen.python.text.imports import Imports
from cspdiag.codegen.python.text.names import PackageNames
from cspdiag.codegen.shared.operations import known_comparison, opposite, truth_of
from cspdiag.model.types import BOOL, DOUBLE, INT, Type
from cspdiag.network.ir.expressions import BinaryOperation, LiteralValue, UnaryOperation, VariableValue
from tests.codegen import networks


def variable(name: str, type_: Type) -> VariableValue:
    return VariableValue(type=type_, channel=name)


def compared(operator: str, type_: Type) -> BinaryOperation:
    return BinaryOperation(type=BOOL, operator=operator, left=variable("a", type_), right=variable("b", type_))


def printed(expression: UnaryOperation) -> str:
    names = PackageNames(networks.commstime())
    return Printer(Imports(names), variable=Name).print(expression).flat


@pytest.mark.parametrize(
    ("operator", "type_", "text"),
    [
        ("<", INT, "a >= b"),
        (">=", INT, "a < b"),
        ("==", INT, "a != b"),
        ("!=", DOUBLE, "a == b"),
        ("<", DOUBLE, "not a < b"),
        (">=", DOUBLE, "not a >= b"),
    ],
)
def test_the_opposite_of_an_order_is_an_order_but_of_reals(operator: str, type_: Type, text: str) -> None:
    """A NaN is unordered with respect to everything."""
    condition = compared(operator, type_)
    assert (opposite(condition) is None) == text.startswith("not ")
    assert printed(UnaryOperation(type=BOOL, operator="not", operand=condition)) == text


def test_the_opposite_of_a_negation_is_what_it_negates() -> None:
    condition = variable("a", BOOL)
    assert opposite(UnaryOperation(type=BOOL, operator="not", operand=condition)) is condition


@pytest.mark.parametrize(
    ("operator", "value", "holds"), [("==", True, True), ("!=", True, False), ("==", False, False)]
)
def test_a_comparison_with_a_truth_value_is_the_condition_or_its_negation(
    operator: str, value: bool, holds: bool
) -> None:
    condition = variable("a", BOOL)
    literal = LiteralValue(type=BOOL, value=value)
    comparison = BinaryOperation(type=BOOL, operator=operator, left=condition, right=literal)
    assert truth_of(comparison) == (condition, holds)


def test_a_constant_is_known_by_its_name_to_compilers_only() -> None:
    named = LiteralValue(type=INT, value=3, name="LIMIT")
    comparison = BinaryOperation(type=BOOL, operator="<", left=named, right=LiteralValue(type=INT, value=4))
    assert known_comparison(comparison, by_name=True) is True
    assert known_comparison(comparison, by_name=False) is None
