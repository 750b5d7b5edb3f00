"""Values of expressions of which not everything is known."""

from __future__ import annotations

import pytest

from cspdiag.model.types import BOOL, DOUBLE, INT, ArrayType, IntType, Type
from cspdiag.network.ir.expressions import (
    BinaryOperation,
    ConditionalValue,
    Conversion,
    ElementValue,
    Expression,
    FunctionCall,
    LiteralValue,
    UnaryOperation,
    Value,
    VariableValue,
)
from cspdiag.proofs.transitions.values import UNKNOWN, EvaluationFault, Known, evaluated, replaced_element, same


def literal(value: Value, kind: Type = INT) -> Expression:
    return LiteralValue(type=kind, value=value)


def variable(name: str, kind: Type = INT) -> Expression:
    return VariableValue(type=kind, channel=name)


def operation(operator: str, left: Expression, right: Expression, kind: Type = INT) -> Expression:
    return BinaryOperation(type=kind, operator=operator, left=left, right=right)  # type: ignore[arg-type]


def value(expression: Expression, **variables: Known) -> Known:
    return evaluated(expression, lambda name: variables.get(name, UNKNOWN), lambda _: UNKNOWN)


HOLDS, FAILS, OPEN = literal(True, BOOL), literal(False, BOOL), variable("u", BOOL)


@pytest.mark.parametrize(
    ("expression", "result"),
    [
        (operation("+", literal(2), variable("x")), 7),
        (operation("/", literal(-7), literal(2)), -3),
        (operation("and", FAILS, OPEN, BOOL), False),
        (operation("and", OPEN, FAILS, BOOL), False),
        (operation("or", OPEN, HOLDS, BOOL), True),
        (operation("or", OPEN, FAILS, BOOL), UNKNOWN),
        (operation("<", variable("x"), variable("y"), BOOL), UNKNOWN),
        (UnaryOperation(type=BOOL, operator="not", operand=OPEN), UNKNOWN),
        (ConditionalValue(type=INT, condition=OPEN, then=literal(1), otherwise=literal(1)), 1),
        (ConditionalValue(type=INT, condition=OPEN, then=literal(1), otherwise=literal(2)), UNKNOWN),
        (ConditionalValue(type=INT, condition=HOLDS, then=literal(1), otherwise=variable("y")), 1),
        (FunctionCall(type=INT, function="max", arguments=(literal(3), variable("x"))), 5),
        (Conversion(type=DOUBLE, operand=variable("x")), 5.0),
        (ElementValue(type=INT, operand=variable("a", ArrayType(INT, 3)), index=literal(2)), 30),
    ],
)
def test_value(expression: Expression, result: Known) -> None:
    assert same(value(expression, x=5, a=(10, 20, 30)), result)


@pytest.mark.parametrize(
    "expression",
    [
        operation("/", literal(1), operation("-", variable("x"), literal(5))),
        Conversion(type=IntType(8), operand=operation("*", variable("x"), literal(100))),
        ElementValue(type=INT, operand=variable("a", ArrayType(INT, 3)), index=literal(3)),
        ElementValue(type=INT, operand=variable("a", ArrayType(INT, 3)), index=literal(-1)),
    ],
)
def test_what_certainly_fails_is_a_fault(expression: Expression) -> None:
    with pytest.raises(EvaluationFault):
        value(expression, x=5, a=(10, 20, 30))


def test_element_is_replaced() -> None:
    assert replaced_element(((1, 2), (3, 4)), (1, 0), 9) == ((1, 2), (9, 4))
    assert replaced_element((1, 2), (UNKNOWN,), 9) is UNKNOWN
    assert replaced_element((1, 2), (0,), UNKNOWN) is UNKNOWN
    with pytest.raises(EvaluationFault):
        replaced_element((1, 2), (2,), 9)


def test_values_that_compare_equal_may_differ() -> None:
    assert not same(1, True)
    assert not same(0.0, -0.0)
    assert same(UNKNOWN, UNKNOWN)
