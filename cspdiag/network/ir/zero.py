"""The default values of types."""

from __future__ import annotations

from typing import assert_never

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
from cspdiag.network.ir.expressions import Value


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
