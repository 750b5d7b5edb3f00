"""Messages as JSON, with a JSON schema that has the units: what any program reads, if more slowly."""

from __future__ import annotations

import json
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
from cspdiag.simulate.record.files import readable

if TYPE_CHECKING:
    import numpy


def json_schema(kind: Type) -> str:
    """The schema of a message: an object with the fields of a struct, or else with a ``value``."""
    inner = _schema(kind)
    if not isinstance(kind, StructType):
        inner = {"type": "object", "properties": {"value": inner}, "required": ["value"]}
    return json.dumps({"title": str(kind), **inner})


def json_messages(values: numpy.ndarray, kind: Type) -> list[bytes]:
    """A message for each value; numbers are the shortest text that is read as the same number."""
    if isinstance(kind, RealType | IntType | TimeType):
        return [b'{"value":%s}' % repr(value).encode() for value in values.tolist()]
    is_struct = isinstance(kind, StructType)
    shown = (readable(value, kind) for value in values.tolist())
    messages = (value if is_struct else {"value": value} for value in shown)
    return [json.dumps(message, separators=(",", ":"), default=_of_numpy).encode() for message in messages]


def _of_numpy(value: Any) -> Any:
    """A number inside an array, which numpy has left as its own."""
    return value.item()


def _schema(kind: Type) -> dict[str, Any]:
    match kind:
        case BoolType():
            return {"type": "boolean"}
        case IntType():
            return {"type": "integer"}
        case TimeType():
            return {"type": "integer", "description": "ns"}
        case RealType(unit=unit):
            return {"type": "number", "description": str(unit)}
        case EnumType(literals=literals):
            return {"type": "string", "enum": list(literals)}
        case StructType(fields=fields):
            properties = {name: _schema(inner) for name, inner in fields}
            return {"type": "object", "properties": properties, "required": list(properties)}
        case ArrayType(element=element, size=size):
            return {"type": "array", "items": _schema(element), "minItems": size, "maxItems": size}
        case TextType() | UnknownType():
            raise ValueError(f"no port has the type {kind}")
        case _:
            assert_never(kind)
