"""Values from messages that are JSON."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, assert_never

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
from cspdiag.simulate.record.leaves import column

if TYPE_CHECKING:
    import numpy


def values_from(texts: Sequence[bytes], kind: Type) -> numpy.ndarray:
    """An array of the values in these messages."""
    found = [json.loads(text) for text in texts]
    return column([_value(each if isinstance(kind, StructType) else each["value"], kind) for each in found], kind)


def _value(data: Any, kind: Type) -> Any:
    match kind:
        case EnumType(literals=literals):
            return literals.index(data)
        case StructType(fields=fields):
            return tuple(_value(data[name], inner) for name, inner in fields)
        case ArrayType(element=element):
            return [_value(part, element) for part in data]
        case BoolType() | IntType() | RealType() | TimeType() | TextType() | UnknownType():
            return data
        case _:
            assert_never(kind)
