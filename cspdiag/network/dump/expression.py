"""Types, values and expressions of the network as text."""

from __future__ import annotations

from typing import assert_never

from cspdiag.model.constants.durations import duration
from cspdiag.model.types import ArrayType, BoolType, EnumType, RealType, StructType, TimeType, Type
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
    Value,
    VariableValue,
)

_LEVELS: dict[str, int] = {
    "or": 1, "and": 2, "==": 4, "!=": 4, "<": 4, "<=": 4, ">": 4, ">=": 4, "+": 5, "-": 5, "*": 6, "/": 6, "%": 6,
    "^": 8,
}  # fmt: skip
_UNARY_LEVEL = {"not": 3, "-": 7}
_TOP = 9


def value_text(value: Value, type_: Type) -> str:
    """A constant as the language writes it, without its unit."""
    match type_:
        case BoolType():
            return "true" if value else "false"
        case TimeType() if isinstance(value, int):
            return duration(value)
        case EnumType(name=name, literals=literals) if isinstance(value, int):
            return f"{name}.{literals[value]}"
        case StructType(name=name, fields=fields) if isinstance(value, tuple):
            parts = (f"{field} = {value_text(part, kind)}" for (field, kind), part in zip(fields, value, strict=True))
            return f"{name}({', '.join(parts)})"
        case ArrayType(element=element) if isinstance(value, tuple):
            return f"[{', '.join(value_text(part, element) for part in value)}]"
        case RealType() if isinstance(value, int | float):
            return repr(float(value))
        case _:  # Numbers, and values that do not fit their type, as they are.
            return repr(value) if not isinstance(value, str) else f'"{value}"'


def expression_text(expression: Expression) -> str:
    """An expression as the language writes it, with no more parentheses than needed."""
    return _text(expression)[0]


def _text(expression: Expression) -> tuple[str, int]:
    """The text of an expression, and how tightly its outermost operator binds."""
    match expression:
        case LiteralValue():
            text = expression.name or value_text(expression.value, expression.type)
            return text, _UNARY_LEVEL["-"] if text.startswith("-") else _TOP
        case ParameterValue() | TunableValue() | SignalValue():
            return expression.name, _TOP
        case VariableValue():
            return expression.channel, _TOP
        case PresentTime():
            return "now" if isinstance(expression.type, TimeType) else "time", _TOP
        case UnaryOperation():
            level = _UNARY_LEVEL[expression.operator]
            space = " " if expression.operator == "not" else ""
            return f"{expression.operator}{space}{_within(expression.operand, level + 1)}", level
        case BinaryOperation():
            return _chain(expression), _LEVELS[expression.operator]
        case ConditionalValue():
            condition, then = expression_text(expression.condition), expression_text(expression.then)
            return f"if {condition} then {then} else {expression_text(expression.otherwise)}", 0
        case FunctionCall(function="until", arguments=(instant, _)):
            return f"until {expression_text(instant)}", 0
        case FunctionCall():
            return f"{expression.function}({_list(expression.arguments)})", _TOP
        case Conversion():
            return f"{expression.type}({expression_text(expression.operand)})", _TOP
        case FieldValue():
            return f"{_within(expression.operand, _TOP)}.{expression.field}", _TOP
        case ElementValue():
            return f"{_within(expression.operand, _TOP)}[{expression_text(expression.index)}]", _TOP
        case StructValue():
            return _struct(expression), _TOP
        case ArrayElements():
            return f"[{_list(expression.values)}]", _TOP
        case _:
            assert_never(expression)


def _within(expression: Expression, level: int) -> str:
    text, own = _text(expression)
    return text if own >= level else f"({text})"


def _list(expressions: tuple[Expression, ...]) -> str:
    return ", ".join(map(expression_text, expressions))


def _struct(expression: StructValue) -> str:
    assert isinstance(expression.type, StructType)
    names = [name for name, _ in expression.type.fields]
    parts = (f"{name} = {expression_text(value)}" for name, value in zip(names, expression.values, strict=True))
    return f"{expression.type.name}({', '.join(parts)})"


def _chain(expression: BinaryOperation) -> str:
    """The text of a chain of operators, which may be thousands long: its left side is followed without recursion."""
    operations = [expression]
    while isinstance(operations[-1].left, BinaryOperation):
        operations.append(operations[-1].left)
    innermost = operations[-1]
    text, level = _text(innermost.left)
    for operation in reversed(operations):
        own = _LEVELS[operation.operator]
        chains = own != 4 and operation.operator != "^"
        if level < own or (level == own and not chains):
            text = f"({text})"
        text = f"{text} {operation.operator} {_within(operation.right, own + 1)}"
        level = own
    return text
