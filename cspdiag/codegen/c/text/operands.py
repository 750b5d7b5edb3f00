"""Properties of operands: their width in C, and values that are known at compile time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import assert_never

from cspdiag.codegen.c.text.code import Code, call, cast
from cspdiag.model.types import IntType, TimeType, Type
from cspdiag.network.ir.expressions import (
    ArrayElements,
    BinaryOperation,
    ConditionalValue,
    Conversion,
    ElementValue,
    Expression,
    FieldValue,
    FunctionCall,
    LiteralValue,
    ParameterValue,
    PresentTime,
    SignalValue,
    StructValue,
    TunableValue,
    UnaryOperation,
    VariableValue,
)
from cspdiag.network.ir.faults import may_fault
from cspdiag.network.ir.ranges import value_range


def is_int64(type_: Type) -> bool:
    """Whether an integer type is ``int64_t`` in C."""
    return isinstance(type_, TimeType) or (isinstance(type_, IntType) and type_.bits == 64)


def widened(code: Code, type_: Type) -> Code:
    """An operand, converted to a type in which no operation on two operands of ``type_`` overflows."""
    small = isinstance(type_, IntType) and (type_.bits == 8 or (type_.bits == 16 and type_.signed))
    return code if small else cast("int64_t", code)


def folded(function: str, codes: Sequence[Code]) -> Code:
    """``function(function(a, b), c)``."""
    result = codes[0]
    for code in codes[1:]:
        result = call(function, result, code)
    return result


def decided_by_ranges(comparison: BinaryOperation) -> bool | None:
    """The result of a comparison of integers if the ranges of its operands decide it, else None."""
    if not isinstance(comparison.left.type, IntType | TimeType):
        return None
    (low, high), (least, greatest) = value_range(comparison.left), value_range(comparison.right)
    apart = high < least or low > greatest
    always, never = {
        "<": (high < least, low >= greatest),
        "<=": (high <= least, low > greatest),
        ">": (low > greatest, high <= least),
        ">=": (low >= greatest, high < least),
        "==": (False, apart),
        "!=": (apart, False),
    }[comparison.operator]
    return always if always or never else None


def known_result(expression: Expression) -> int | None:
    """The value of an operation on literals, if it has one: compilers would compute it, too, and warn about the code
    around it.
    """
    if isinstance(expression, LiteralValue) and expression.name is None and type(expression.value) is int:
        return expression.value
    if not isinstance(expression, BinaryOperation) or not isinstance(expression.type, IntType):
        return None
    left, right = known_result(expression.left), known_result(expression.right)
    if left is None or right is None:
        return None
    match expression.operator:
        case "+":
            value = left + right
        case "-":
            value = left - right
        case "*":
            value = left * right
        case "/" | "%" if right != 0:
            quotient = abs(left) // abs(right) * (1 if (left < 0) == (right < 0) else -1)
            value = quotient if expression.operator == "/" else left - quotient * right
        case "/" | "%" | "^" | "==" | "!=" | "<" | "<=" | ">" | ">=" | "and" | "or":
            return None
        case _:
            assert_never(expression.operator)
    return value if expression.type.minimum <= value <= expression.type.maximum else None


def is_undefined_in_c(expression: BinaryOperation) -> bool:
    """Whether an operation may be undefined in C although it has a value: the remainder of the least integer and -1."""
    low, high = value_range(expression.right)
    return expression.operator == "%" and low <= -1 <= high and value_range(expression.left)[0] == IntType().minimum


def is_lvalue(expression: Expression) -> bool:
    """Whether the C expression is an lvalue, so its elements are as well."""
    match expression:
        case FieldValue(operand=operand):
            return is_lvalue(operand)
        case ElementValue(operand=operand):
            return is_lvalue(operand) and not may_fault(expression)
        case StructValue() | ArrayElements():
            return not may_fault(expression)
        case LiteralValue() | ParameterValue() | TunableValue() | VariableValue() | SignalValue():
            return True
        case (
            PresentTime() | UnaryOperation() | BinaryOperation() | ConditionalValue() | FunctionCall() | Conversion()
        ):  # fmt: skip
            return False
        case _:
            assert_never(expression)
