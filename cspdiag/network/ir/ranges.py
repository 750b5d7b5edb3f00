"""The ranges of whole numbers and times in expressions, by interval arithmetic, and which of them may leave the range
of their type.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeAlias, assert_never

from cspdiag.model.types import (
    ArrayType,
    BoolType,
    EnumType,
    IntType,
    RealType,
    StructType,
    TextType,
    TimeType,
    Type,
    UnknownType,
)
from cspdiag.network.ir.expressions import (
    ArrayElements,
    BinaryOperation,
    BinaryOperator,
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
from cspdiag.network.ir.walk import parts

Range: TypeAlias = tuple[int, int]
"""The least and the greatest value."""

ExpressionInput: TypeAlias = "ParameterValue | VariableValue | SignalValue | PresentTime"
"""The inputs that an expression is computed from."""

Lookup: TypeAlias = "Callable[[ExpressionInput], Range | None]"
"""The range of a parameter, a variable, a signal or the present time; None if it may be any value of its type."""

_WORD = IntType()


def of_instances(name: ExpressionInput) -> Range | None:
    """The range of a parameter over the instances of a class, once all are known, or of a variable that counts; None
    for everything else.
    """
    return name.range if isinstance(name, ParameterValue | VariableValue) else None


def needs_check(expression: Expression, known: Lookup = of_instances) -> bool:
    """Whether a whole-number operation may overflow: it needs no check only if the ranges of its operands exclude that.

    An operation on parameters and indexes alone may overflow, too: even if that is known before the run, it is a fault
    during the run, at its place and only if it is reached.
    """
    low, high = _result(expression, known)
    bounds = limits_of(expression.type)
    return low < bounds[0] or high > bounds[1]


def exceeds(expression: Expression) -> tuple[bool, bool]:
    """Whether a whole-number operation may leave the range of its type below, and above."""
    low, high = _result(expression)
    bounds = limits_of(expression.type)
    return low < bounds[0], high > bounds[1]


def cannot_fault(expression: Expression) -> bool:
    """Whether the expression is only read and not computed, so it does not matter when it is evaluated."""
    stored = LiteralValue | ParameterValue | VariableValue | FieldValue | StructValue | ArrayElements
    return all(isinstance(part, stored) for part in parts(expression))


def value_range(expression: Expression, known: Lookup = of_instances) -> Range:
    """The least and the greatest value that a whole number or a time can have, if it does not fault."""
    low, high = _result(expression, known)
    bounds = limits_of(expression.type)
    return max(low, bounds[0]), min(high, bounds[1])


def limits_of(type_: Type) -> Range:
    """The least and the greatest value of a type of whole numbers; those of ``int`` for other types."""
    match type_:
        case IntType():
            return type_.minimum, type_.maximum
        case EnumType(literals=literals):
            return 0, len(literals) - 1
        case (
            BoolType() | RealType() | TimeType() | TextType() | StructType() | ArrayType() | UnknownType()
        ):  # fmt: skip
            return _WORD.minimum, _WORD.maximum
        case _:
            assert_never(type_)


def joined(several: Iterable[Range]) -> Range:
    """The smallest range that contains all the given ranges, of which there is at least one."""
    lows, highs = zip(*several, strict=True)
    return min(lows), max(highs)


def _result(expression: Expression, known: Lookup = of_instances) -> Range:
    """The range of the result of an operation before it is checked."""
    match expression:
        case LiteralValue(value=int(value)):
            return value, value
        case ParameterValue() | VariableValue() | SignalValue() | PresentTime():
            return known(expression) or limits_of(expression.type)
        case UnaryOperation(operator="-", operand=operand):
            low, high = value_range(operand, known)
            return -high, -low
        case BinaryOperation(operator=operator, left=left, right=right):
            return _operation(operator, value_range(left, known), value_range(right, known), limits_of(expression.type))
        case ConditionalValue(then=then, otherwise=otherwise):
            return joined((value_range(then, known), value_range(otherwise, known)))
        case FunctionCall(function="abs", arguments=(operand,)):
            low, high = value_range(operand, known)
            return 0 if low <= 0 <= high else min(abs(low), abs(high)), max(abs(low), abs(high))
        case FunctionCall(function="min" | "max" as function, arguments=arguments):
            choose = min if function == "min" else max
            lows, highs = zip(*(value_range(argument, known) for argument in arguments), strict=True)
            return choose(lows), choose(highs)
        case (
            LiteralValue() | TunableValue() | UnaryOperation() | FunctionCall() | Conversion()
            | FieldValue() | ElementValue() | StructValue() | ArrayElements()
        ):  # fmt: skip
            return limits_of(expression.type)
        case _:
            assert_never(expression)


def _operation(operator: BinaryOperator, left: Range, right: Range, bounds: Range) -> Range:
    match operator:
        case "+":
            return left[0] + right[0], left[1] + right[1]
        case "-":
            return left[0] - right[1], left[1] - right[0]
        case "*":
            products = [a * b for a in left for b in right]
            return min(products), max(products)
        case "/":
            return _quotient(left, right)
        case "%":
            largest = max(abs(right[0]), abs(right[1]), 1) - 1
            return max(-largest, min(left[0], 0)), min(largest, max(left[1], 0))
        case "^" if left[0] == left[1] and right[0] == right[1] and 0 <= right[0] < 64:
            return left[0] ** right[0], left[0] ** right[0]
        case "^":
            return bounds[0] - 1, bounds[1] + 1
        case "==" | "!=" | "<" | "<=" | ">" | ">=" | "and" | "or":
            return bounds
        case _:
            assert_never(operator)


def _quotient(left: Range, right: Range) -> Range:
    """The range of a quotient, truncated toward zero; division by zero is a fault. For divisors on one side of zero,
    the extremes are at the bounds.
    """
    divisors = [
        (low, high) for low, high in ((right[0], min(right[1], -1)), (max(right[0], 1), right[1])) if low <= high
    ]
    if not divisors:
        return 0, 0
    quotients = [abs(a) // abs(b) * (1 if (a < 0) == (b < 0) else -1) for a in left for pair in divisors for b in pair]
    return min(quotients), max(quotients)
