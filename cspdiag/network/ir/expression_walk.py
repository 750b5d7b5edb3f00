"""The parts of expressions, and the signals that they read."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from operator import attrgetter
from typing import Any

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


def operands(expression: Expression) -> tuple[Expression, ...]:
    """The expressions directly inside, in text order."""
    return _OPERANDS[type(expression)](expression)


def _none(_: object) -> tuple[()]:
    return ()


def _operand(expression: UnaryOperation | Conversion | FieldValue) -> tuple[Expression]:
    return (expression.operand,)


# A table, because a `match` tries one class after another, and networks have many expressions.
_OPERANDS: dict[type, Callable[[Any], tuple[Expression, ...]]] = {
    LiteralValue: _none,
    ParameterValue: _none,
    TunableValue: _none,
    VariableValue: _none,
    SignalValue: _none,
    PresentTime: _none,
    UnaryOperation: _operand,
    Conversion: _operand,
    FieldValue: _operand,
    BinaryOperation: attrgetter("left", "right"),
    ConditionalValue: attrgetter("condition", "then", "otherwise"),
    FunctionCall: attrgetter("arguments"),
    ElementValue: attrgetter("operand", "index"),
    StructValue: attrgetter("values"),
    ArrayElements: attrgetter("values"),
}


def walk(expression: Expression) -> Iterator[Expression]:
    """The expression and everything inside it, in text order."""
    pending = [expression]
    while pending:
        present = pending.pop()
        yield present
        pending.extend(reversed(operands(present)))


def signals_read(expression: Expression) -> list[str]:
    """Names of the signals that an expression reads, each once, in text order."""
    found: dict[str, None] = {}
    pending = [expression]
    while pending:
        present = pending.pop()
        if isinstance(present, SignalValue):
            found[present.name] = None
        else:
            pending.extend(reversed(operands(present)))
    return list(found)
