"""Messages as JSON, with a JSON schema that has the units: what any program reads, if more slowly."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping, Sequence
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
from cspdiag.simulate.record.streamed.blocks import Block, in_order
from cspdiag.simulate.record.streamed.mcap.mcap_records import HEAD_OF_MESSAGE, Opcode

if TYPE_CHECKING:
    import numpy


class JsonChunk:
    """The messages of some blocks in order of time: ``size`` bytes in all. ``kinds`` are the types of all ports,
    ``numbers`` how many messages each has had.
    """

    def __init__(self, blocks: Sequence[Block], kinds: Sequence[Type], numbers: Mapping[int, int]) -> None:
        found: list[bytes] = []
        pack = struct.Struct("<BQHIQQ").pack
        for block in blocks:
            port, first = block.port, numbers[block.port]
            bodies = json_messages(block.value, kinds[port])
            for number, (time, body) in enumerate(zip(block.time.tolist(), bodies, strict=True), first):
                length = HEAD_OF_MESSAGE - 9 + len(body)
                found.append(pack(Opcode.MESSAGE, length, port + 1, number & 0xFFFFFFFF, time, time) + body)
        order = in_order(blocks).tolist()
        self._counts = [len(block.time) for block in blocks]
        self._offsets = [0] * len(found)
        self.size = 0
        for at in order:
            self._offsets[at] = self.size
            self.size += len(found[at])
        self._data = b"".join([found[at] for at in order])

    def offsets(self) -> list[numpy.ndarray]:
        """Where each message of each block is."""
        import numpy

        return numpy.split(numpy.array(self._offsets, numpy.int64), numpy.cumsum(self._counts)[:-1])

    def write(self, into: numpy.ndarray, numbers: Sequence[int]) -> None:
        """Write the messages."""
        import numpy

        into[...] = numpy.frombuffer(self._data, numpy.uint8)


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
