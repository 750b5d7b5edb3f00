"""The ranges of expressions contain every possible value, and the bounds of quotients are reached."""

from __future__ import annotations

from itertools import product

import pytest

from cspdiag.model.types import IntType
from cspdiag.network.ir.expressions import BinaryOperation, Expression, FunctionCall, ParameterValue, UnaryOperation
from cspdiag.network.ir.ranges import needs_check, value_range

INT8 = IntType(8)
RANGES = [(low, high) for low in range(-3, 4) for high in range(low, 4)] + [(-128, 127), (-128, -128), (0, 127)]


def parameter(name: str, known: tuple[int, int]) -> ParameterValue:
    return ParameterValue(type=INT8, name=name, range=known)


def truncated(one: int, other: int) -> int:
    return int(one / other)


def remainder(one: int, other: int) -> int:
    return one - other * truncated(one, other)


OPERATIONS = {
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
    "/": truncated,
    "%": remainder,
    "min": min,
    "max": max,
}


def operation(operator: str, left: Expression, right: Expression) -> Expression:
    if operator in ("min", "max"):
        return FunctionCall(type=INT8, function=operator, arguments=(left, right))  # type: ignore[arg-type]
    return BinaryOperation(type=INT8, operator=operator, left=left, right=right)  # type: ignore[arg-type]


@pytest.mark.parametrize("operator", OPERATIONS)
def test_operations(operator: str) -> None:
    compute = OPERATIONS[operator]
    for left, right in product(RANGES[:-3], repeat=2):
        values = [
            compute(a, b)
            for a, b in product(range(left[0], left[1] + 1), range(right[0], right[1] + 1))
            if b or operator not in "/%"
        ]
        low, high = value_range(operation(operator, parameter("a", left), parameter("b", right)))
        assert all(low <= value <= high for value in values), (left, right)
        if values and operator != "%":
            assert (low, high) == (min(values), max(values)), (left, right)


@pytest.mark.parametrize(
    ("operator", "left", "right", "expected"),
    [
        ("/", (-128, 127), (-1, 1), True),
        ("/", (-128, 127), (0, 127), False),
        ("/", (-128, 127), (-128, -2), False),
        ("/", (-127, 127), (-1, 1), False),
        ("+", (-128, 127), (0, 1), True),
        ("-", (0, 127), (0, 127), False),
    ],
)
def test_what_may_leave_the_range_is_checked(
    operator: str, left: tuple[int, int], right: tuple[int, int], expected: bool
) -> None:
    assert needs_check(operation(operator, parameter("a", left), parameter("b", right))) is expected


def test_a_negated_range() -> None:
    negated = UnaryOperation(type=INT8, operator="-", operand=parameter("a", (-128, 3)))
    assert value_range(negated) == (-3, 127)
    assert needs_check(negated)
