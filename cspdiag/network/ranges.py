"""What can go wrong when an expression is evaluated: integers that leave the range of their type."""

from __future__ import annotations

from cspdiag.model.types import EnumType, IntType, TimeType, Type
from cspdiag.network.expressions import (
    ArrayElements,
    BinaryOperation,
    ConditionalValue,
    Expression,
    FieldValue,
    FunctionCall,
    LiteralValue,
    ParameterValue,
    StructValue,
    UnaryOperation,
    VariableValue,
)
from cspdiag.network.walk import parts

Range = tuple[int, int]

_WORD = IntType()


def needs_check(expression: Expression) -> bool:
    """Whether a whole-number operation may overflow: only one whose operands have ranges that exclude it needs no check.

    That an operation is over parameters and indices alone does not say that it stays in range. What is known before the run is a fault
    of the run, where it stands and if it is reached.
    """
    low, high = _result(expression)
    bounds = _bounds(expression.type)
    return low < bounds[0] or high > bounds[1]


def exceeds(expression: Expression) -> tuple[bool, bool]:
    """Whether a whole-number operation may leave the range of its type below, and above."""
    low, high = _result(expression)
    bounds = _bounds(expression.type)
    return low < bounds[0], high > bounds[1]


def cannot_fault(expression: Expression) -> bool:
    """Whether evaluating the expression computes nothing, so that it does not matter when it is evaluated."""
    stored = LiteralValue | ParameterValue | VariableValue | FieldValue | StructValue | ArrayElements
    return all(isinstance(part, stored) for part in parts(expression))


def value_range(expression: Expression) -> Range:
    """The least and the greatest value that a whole-number expression can have, if it does not fault."""
    return _range(expression)


def _bounds(type_: Type) -> Range:
    match type_:
        case IntType():
            return type_.minimum, type_.maximum
        case TimeType():
            return _WORD.minimum, _WORD.maximum
        case EnumType(literals=literals):
            return 0, len(literals) - 1
    return _WORD.minimum, _WORD.maximum


def _range(expression: Expression) -> Range:
    """The values an expression can have once it was checked."""
    low, high = _result(expression)
    bounds = _bounds(expression.type)
    return max(low, bounds[0]), min(high, bounds[1])


def _result(expression: Expression) -> Range:
    """The values an operation can have before it is checked."""
    match expression:
        case LiteralValue(value=int(value)):
            return value, value
        case ParameterValue(range=tuple(known)):
            return known
        case UnaryOperation(operator="-", operand=operand):
            low, high = _range(operand)
            return -high, -low
        case BinaryOperation(operator=operator, left=left, right=right):
            return _operation(operator, _range(left), _range(right), _bounds(expression.type))
        case ConditionalValue(then=then, otherwise=otherwise):
            first, second = _range(then), _range(otherwise)
            return min(first[0], second[0]), max(first[1], second[1])
        case FunctionCall(function="abs", arguments=(operand,)):
            low, high = _range(operand)
            return 0 if low <= 0 <= high else min(abs(low), abs(high)), max(abs(low), abs(high))
        case FunctionCall(function="min", arguments=arguments):
            ranges = [_range(argument) for argument in arguments]
            return min(low for low, _ in ranges), min(high for _, high in ranges)
        case FunctionCall(function="max", arguments=arguments):
            ranges = [_range(argument) for argument in arguments]
            return max(low for low, _ in ranges), max(high for _, high in ranges)
    return _bounds(expression.type)


def _operation(operator: str, left: Range, right: Range, bounds: Range) -> Range:
    match operator:
        case "+":
            return left[0] + right[0], left[1] + right[1]
        case "-":
            return left[0] - right[1], left[1] - right[0]
        case "*":
            products = [a * b for a in left for b in right]
            return min(products), max(products)
        case "/":
            largest = max(abs(left[0]), abs(left[1]))
            if right[0] > 0:
                return min(left[0], 0), max(left[1], 0)
            return -largest, largest
        case "%":
            largest = max(abs(right[0]), abs(right[1]), 1) - 1
            return max(-largest, min(left[0], 0)), min(largest, max(left[1], 0))
        case "^" if left[0] == left[1] and right[0] == right[1] and 0 <= right[0] < 64:
            return left[0] ** right[0], left[0] ** right[0]
        case "^":
            return bounds[0] - 1, bounds[1] + 1
    return bounds
