"""What is folded at compile time has the same bits as at run time, and what faults is not folded."""

from __future__ import annotations

import struct
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from cspdiag.model.types import BOOL, DOUBLE, INT, TIME, IntType, RealType, Type
from cspdiag.model.units import Unit
from cspdiag.network.ir.expressions import (
    BinaryOperation,
    ConditionalValue,
    Conversion,
    Expression,
    FunctionCall,
    LiteralValue,
    UnaryOperation,
    VariableValue,
)
from cspdiag.network.ir.faults import may_fault
from cspdiag.optimize.constants.folding import LIBRARY_FUNCTIONS, folded_with
from cspdiag.semantics.values import FaultError, value_of

INT8 = IntType(bits=8)
FLOAT = RealType(bits=32)
NUMBERS = (INT, INT8, DOUBLE, FLOAT, TIME)
ARITHMETIC = {INT: "+-*/%^", INT8: "+-*/%", DOUBLE: "+-*/%^", FLOAT: "+-*/", TIME: "+-"}
FUNCTIONS: dict[str, int] = {
    "abs": 1, "min": 2, "max": 2, "limit": 3, "sign": 1, "sqrt": 1, "floor": 1, "ceil": 1, "round": 1, "sin": 1,
    "exp": 1,
}  # fmt: skip


def single(value: float) -> float:
    return float(struct.unpack("f", struct.pack("f", value))[0])


VALUES: dict[Type, st.SearchStrategy[Any]] = {
    BOOL: st.booleans(),
    INT: st.sampled_from([0, 1, -1, 2, 7, 63, 2**62, 2**63 - 1, -(2**63)]),
    INT8: st.sampled_from([0, 1, -1, 3, 100, 127, -128]),
    TIME: st.sampled_from([0, 1, 1_000_000, 2**62, -(2**63)]),
    DOUBLE: st.sampled_from([0.0, -0.0, 1.0, -1.0, 0.5, -1.5, 2.5, 1e-300, 1e300, 0.1, 3.0]),
    FLOAT: st.sampled_from([0.0, -0.0, 1.0, -1.0, 0.5, single(0.1), single(3e38), single(1e-40)]),
}


@st.composite
def expressions(draw: st.DrawFn, kind: Type, depth: int) -> Expression:
    """An expression of literals, and of variables ``v_<type>`` whose values are not known."""
    if depth == 0 or draw(st.integers(0, 4)) == 0:
        if draw(st.integers(0, 5)) == 0:
            return VariableValue(type=kind, channel=f"v_{kind}")
        return LiteralValue(type=kind, value=draw(VALUES[kind]))

    def inner(inner_kind: Type) -> Expression:
        return draw(expressions(inner_kind, depth - 1))

    if kind == BOOL:
        other = draw(st.sampled_from(NUMBERS))
        comparison = draw(st.sampled_from(["==", "!=", "<", "<=", ">", ">="]))
        logic = draw(st.sampled_from(["and", "or"]))
        form = draw(st.integers(0, 2))
        if form == 0:
            return BinaryOperation(type=BOOL, operator=comparison, left=inner(other), right=inner(other))
        if form == 1:
            return BinaryOperation(type=BOOL, operator=logic, left=inner(BOOL), right=inner(BOOL))
        return UnaryOperation(type=BOOL, operator="not", operand=inner(BOOL))
    form = draw(st.integers(0, 4))
    if form == 0:
        return ConditionalValue(type=kind, condition=inner(BOOL), then=inner(kind), otherwise=inner(kind))
    if form == 1:
        return UnaryOperation(type=kind, operator="-", operand=inner(kind))
    if form == 2 and kind != TIME:
        reals_only = not isinstance(kind, RealType)
        names = sorted(name for name in FUNCTIONS if not reals_only or name in ("abs", "min", "max", "limit", "sign"))
        function: Any = draw(st.sampled_from(names))
        arguments = tuple(inner(kind) for _ in range(FUNCTIONS[function]))
        return FunctionCall(type=kind, function=function, arguments=arguments)
    if form == 3 and kind != TIME:
        return Conversion(type=kind, operand=inner(draw(st.sampled_from([INT, INT8, DOUBLE]))))
    operator: Any = draw(st.sampled_from(ARITHMETIC[kind]))
    return BinaryOperation(type=kind, operator=operator, left=inner(kind), right=inner(kind))


def evaluated(expression: Expression, variables: dict[str, Any]) -> Any:
    """The value to the last bit, or the fault."""
    try:
        return repr(value_of(expression, {}, variables.__getitem__, {}.__getitem__))
    except FaultError:
        return "fault"


@settings(max_examples=400, derandomize=True, deadline=None)
@given(st.sampled_from([*NUMBERS, BOOL]).flatmap(lambda kind: expressions(kind, 3)), st.data())
def test_folding_keeps_the_value_and_the_fault(expression: Expression, data: st.DataObject) -> None:
    variables = {f"v_{kind}": data.draw(values) for kind, values in VALUES.items()}
    result = folded_with(expression, {})
    assert evaluated(result, variables) == evaluated(expression, variables)
    assert folded_with(result, {}) == result


@settings(max_examples=400, derandomize=True, deadline=None)
@given(st.sampled_from([*NUMBERS, BOOL]).flatmap(lambda kind: expressions(kind, 3)), st.data())
def test_what_cannot_fault_does_not(expression: Expression, data: st.DataObject) -> None:
    variables = {f"v_{kind}": data.draw(values) for kind, values in VALUES.items()}
    if not may_fault(expression):
        assert evaluated(expression, variables) != "fault"


def test_functions_of_the_library_are_left_to_the_machine() -> None:
    half = LiteralValue(type=DOUBLE, value=0.5)
    for function in sorted(LIBRARY_FUNCTIONS - {"atan2"}):
        call = FunctionCall(type=DOUBLE, function=function, arguments=(half,))  # type: ignore[arg-type]
        assert folded_with(call, {}) == call


def test_known_variables_are_put_in_their_places() -> None:
    one = LiteralValue(type=INT, value=1)
    count = VariableValue(type=INT, channel="count")
    total = BinaryOperation(type=INT, operator="+", left=count, right=one)
    assert folded_with(total, {"count": LiteralValue(type=INT, value=6)}) == LiteralValue(type=INT, value=7)


def test_arithmetic_that_changes_nothing_is_removed_also_between_units() -> None:
    length = RealType(unit=Unit((0, 1, 0, 0, 0, 0, 0)))
    x = VariableValue(type=length, channel="x")

    def with_literal(operator: Any, value: float) -> Expression:
        right = LiteralValue(type=length, value=value)
        return folded_with(BinaryOperation(type=DOUBLE, operator=operator, left=x, right=right), {})

    assert with_literal("/", 1.0) == with_literal("*", 1.0) == with_literal("-", 0.0) == x
    minus = UnaryOperation(type=DOUBLE, operator="-", operand=x)
    assert with_literal("/", -1.0) == with_literal("*", -1.0) == minus
    assert isinstance(with_literal("+", 0.0), BinaryOperation), "a negative zero becomes 0"
