"""The ports of the outermost process, with values."""

from __future__ import annotations

from typing import assert_never

from cspdiag.base import Report
from cspdiag.model.constants.evaluate import evaluate
from cspdiag.model.program import Program, Value
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
from cspdiag.network.infer.kinds import Asked
from cspdiag.network.ir.network import ChannelKind, ExternalPort
from cspdiag.network.shapes import AskedKind, Key, PortShape, Shape
from cspdiag.syntax import ast


def external_ports(program: Program, shape: Shape, asked: Asked, report: Report) -> tuple[ExternalPort, ...]:
    """Every port of the outermost process, an array of ports element by element."""
    return tuple(
        _external(program, shape, port, index, key, asked, report) for port, (_, index), key in shape.port_elements()
    )


def _external(
    program: Program, shape: Shape, port: PortShape, index: int | None, key: Key, asked: Asked, report: Report
) -> ExternalPort:
    declaration = port.symbol.declaration

    def value(expression: ast.Expression | None) -> Value | None:
        return None if expression is None else evaluate(program, expression, shape.values, report)

    safe = value(declaration.safe)
    if port.direction == "out" and safe is None:
        safe = zero(port.type)
    return ExternalPort(
        name=key,
        doc=declaration.doc,
        span=port.span,
        direction=port.direction,
        type=port.type,
        index=index,
        period=port.period,
        immediate=declaration.immediate,
        safe=safe,
        default=value(declaration.default),
        kind=_kind(asked.get(key, {})),
    )


def _kind(asked: dict[str, AskedKind]) -> ChannelKind:
    return "broadcast" if "broadcast" in asked else "any" if "any" in asked else "sync"


def zero(type_: Type) -> Value:
    """Zero, false, the first literal of an enum, and the same in every field and element."""
    match type_:
        case BoolType():
            return False
        case IntType() | TimeType() | EnumType():
            return 0
        case RealType():
            return 0.0
        case StructType():
            return tuple(zero(kind) for _, kind in type_.fields)
        case ArrayType():
            return (zero(type_.element),) * (type_.size or 0)
        case TextType():
            return ""
        case UnknownType():
            return 0
        case _:
            assert_never(type_)
