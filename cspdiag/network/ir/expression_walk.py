"""The parts of expressions, and the signals that they read."""

from __future__ import annotations

from collections.abc import Iterator
from typing import assert_never

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
    UnaryOperation,
    VariableValue,
)


def operands(expression: Expression) -> tuple[Expression, ...]:
    """The expressions directly inside, in text order."""
    match expression:
        case LiteralValue() | ParameterValue() | VariableValue() | SignalValue() | PresentTime():
            return ()
        case UnaryOperation() | Conversion() | FieldValue():
            return (expression.operand,)
        case BinaryOperation():
            return (expression.left, expression.right)
        case ConditionalValue():
            return (expression.condition, expression.then, expression.otherwise)
        case FunctionCall():
            return expression.arguments
        case ElementValue():
            return (expression.operand, expression.index)
        case StructValue() | ArrayElements():
            return expression.values
        case _:
            assert_never(expression)


def walk(expression: Expression) -> Iterator[Expression]:
    """The expression and everything inside it, in text order."""
    pending = [expression]
    while pending:
        present = pending.pop()
        yield present
        pending.extend(reversed(operands(present)))


def signals_read(expression: Expression) -> list[str]:
    """Names of the signals that an expression reads, each once, in text order."""
    return list(dict.fromkeys(part.name for part in walk(expression) if isinstance(part, SignalValue)))
