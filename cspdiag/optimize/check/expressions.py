"""Checks an expression of the network: undeclared names, and types that do not agree."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import assert_never

from cspdiag.base.record import node
from cspdiag.model.types import (
    BOOL,
    TIME,
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
from cspdiag.network.dump.expression import expression_text
from cspdiag.network.ir.expression_walk import walk
from cspdiag.network.ir.expressions import (
    ARITY,
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
from cspdiag.network.ir.network import ClassParameter


@node
class Names:
    """The types of the names that an expression may use."""

    parameters: Mapping[str, Type]
    variables: Mapping[str, Type]
    signals: Mapping[str, Type]
    tunable: Mapping[str, Type]
    time: Type | None = None
    """The type of the present instant, if it is known."""


def types_of(parameters: Iterable[ClassParameter], *, tunable: bool) -> dict[str, Type]:
    """The types of the tunable or of the other parameters, by name."""
    return {parameter.name: parameter.type for parameter in parameters if parameter.tunable == tunable}


def agrees(one: Type, other: Type) -> bool:
    """Whether values of two types are represented alike; units do not matter in the network."""
    match one, other:
        case RealType(), RealType():
            return one.bits == other.bits
        case ArrayType(), ArrayType():
            return one.size == other.size and agrees(one.element, other.element)
        case StructType(), StructType():
            return one.name == other.name
        case _:  # Types without units and parts.
            return one == other


def expression_problems(expression: Expression, names: Names, wanted: Type | None = None) -> Iterator[str]:
    """The problems of an expression that may use ``names`` and must have the type ``wanted``."""
    if wanted is not None and not agrees(expression.type, wanted):
        yield f"`{expression_text(expression)}` is {expression.type} where {wanted} is needed"
    for part in walk(expression):
        for problem in _wrong(part, names):
            yield f"`{expression_text(part)}` {problem}"


def _wrong(part: Expression, names: Names) -> Iterator[str]:
    match part:
        case LiteralValue():
            if not is_value_of(part.value, part.type):
                yield f"is not of type {part.type}"
        case ParameterValue():
            yield from _wrong_name(part, part.name, names.parameters, "parameter")
        case TunableValue():
            yield from _wrong_name(part, part.name, names.tunable, "tunable parameter")
        case VariableValue():
            yield from _wrong_name(part, part.channel, names.variables, "variable")
        case SignalValue():
            yield from _wrong_name(part, part.name, names.signals, "signal")
        case PresentTime():
            yield from _differing(names.time, part.type) if names.time is not None else ("is in a control law",)
        case UnaryOperation():
            wanted = BOOL if part.operator == "not" else part.type
            yield from _differing(part.type, wanted, part.operand.type)
        case BinaryOperation():
            yield from _wrong_operation(part)
        case ConditionalValue():
            yield from _differing(BOOL, part.condition.type)
            yield from _differing(part.type, part.then.type, part.otherwise.type)
        case FunctionCall():
            if len(part.arguments) != ARITY.get(part.function, 1):
                yield f"has {len(part.arguments)} arguments"
            elif part.function == "seconds":
                yield from _differing(TIME, part.arguments[0].type)
            else:
                yield from _differing(part.type, *(argument.type for argument in part.arguments))
        case Conversion():
            if isinstance(part.type, StructType | ArrayType) or isinstance(part.operand.type, StructType | ArrayType):
                yield f"converts {part.operand.type} to {part.type}"
        case FieldValue():
            found = part.operand.type.field(part.field) if isinstance(part.operand.type, StructType) else None
            yield from (f"takes a field that {part.operand.type} does not have",) if found is None else ()
            yield from () if found is None else _differing(part.type, found)
        case ElementValue():
            if not isinstance(part.operand.type, ArrayType):
                yield f"takes an element of {part.operand.type}"
            elif not isinstance(part.index.type, IntType):
                yield f"has an index that is {part.index.type}"
            else:
                yield from _differing(part.type, part.operand.type.element)
        case StructValue():
            fields = part.type.fields if isinstance(part.type, StructType) else ()
            yield from _wrong_elements(part, [kind for _, kind in fields])
        case ArrayElements():
            size, element = (part.type.size or 0, part.type.element) if isinstance(part.type, ArrayType) else (0, BOOL)
            yield from _wrong_elements(part, [element] * size)
        case _:
            assert_never(part)


def _wrong_name(part: Expression, name: str, known: Mapping[str, Type], what: str) -> Iterator[str]:
    if name not in known:
        yield f"names no {what}"
    else:
        yield from _differing(part.type, known[name])


def _wrong_operation(part: BinaryOperation) -> Iterator[str]:
    left, right = part.left.type, part.right.type
    match part.operator:
        case "and" | "or":
            yield from _differing(BOOL, part.type, left, right)
        case "==" | "!=" | "<" | "<=" | ">" | ">=":
            yield from _differing(BOOL, part.type)
            yield from _differing(left, right)
        case "*" | "/" | "%" if TIME in (left, right):
            yield from _differing(part.type, IntType() if part.operator == "/" and left == right else TIME)
        case "+" | "-" | "*" | "/" | "%" | "^":
            yield from _differing(part.type, left, right)
        case _:
            assert_never(part.operator)


def _wrong_elements(part: StructValue | ArrayElements, wanted: list[Type]) -> Iterator[str]:
    if len(part.values) != len(wanted):
        yield f"has {len(part.values)} values, and is {part.type}"
    for value, kind in zip(part.values, wanted, strict=False):
        yield from _differing(kind, value.type)


def _differing(wanted: Type, *found: Type) -> Iterator[str]:
    for kind in found:
        if not agrees(kind, wanted):
            yield f"has {kind} where {wanted} is needed"


def is_value_of(value: Value, kind: Type) -> bool:
    """Whether a value belongs to a type."""
    match kind:
        case BoolType():
            return isinstance(value, bool)
        case IntType():
            return type(value) is int and kind.minimum <= value <= kind.maximum
        case RealType():
            return type(value) is float
        case TimeType():
            return type(value) is int
        case TextType():
            return isinstance(value, str)
        case EnumType():
            return type(value) is int and 0 <= value < len(kind.literals)
        case StructType():
            return (
                isinstance(value, tuple)
                and len(value) == len(kind.fields)
                and all(is_value_of(part, field) for part, (_, field) in zip(value, kind.fields, strict=True))
            )
        case ArrayType():
            return (
                isinstance(value, tuple)
                and len(value) == kind.size
                and all(is_value_of(part, kind.element) for part in value)
            )
        case UnknownType():
            return False
        case _:
            assert_never(kind)
