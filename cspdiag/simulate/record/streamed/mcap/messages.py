"""The messages of ROS 2 (.msg definitions, CDR) for the types of ports: numbers to the bit.

A single number is a message of std_msgs; everything else has a definition of its own, in the package ``cspdiag_msgs``.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, assert_never

from cspdiag.base.record import record
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
from cspdiag.simulate.record.leaves import leaf_of_each, leaves

if TYPE_CHECKING:
    import numpy

_PACKAGE = "cspdiag_msgs"
_LINE = "=" * 80
_HEADER = b"\0\1\0\0"
"""CDR, little endian."""


def header() -> bytes:
    """What each message begins with."""
    return _HEADER


@record
class Message:
    """A message type: its ROS name, its definition, and the layout of its numbers after the header: offsets, numpy
    codes, and the bytes of all.
    """

    name: str
    definition: str
    offsets: tuple[int, ...]
    codes: tuple[str, ...]
    size: int


def message_of(kind: Type) -> Message:
    """The message that has one value of a type."""
    found: dict[str, str] = {}
    name = _named(kind, found)
    own = found.pop(name)
    parts = [own, *(f"{_LINE}\nMSG: {other}\n{text}" for other, text in found.items())]
    offsets, codes, position = [], [], 0
    for _, number, _ in leaves("", kind):
        code = _code(number)
        size = int(code[2:])
        position = -(-position // size) * size
        offsets.append(position)
        codes.append(code)
        position += size
    return Message(_full(name), "".join(parts), tuple(offsets), tuple(codes), len(_HEADER) + position)


def encoded(message: Message, values: numpy.ndarray, kind: Type) -> numpy.ndarray:
    """The messages with these values, as bytes of shape ``(n, message.size)``."""
    import numpy

    into = numpy.zeros((len(values), message.size), numpy.uint8)
    into[:, : len(_HEADER)] = numpy.frombuffer(_HEADER, numpy.uint8)
    records = into.view(_layout(message)).reshape(-1)
    for position, (_, _, path) in enumerate(leaves("", kind)):
        records[f"f{position}"] = leaf_of_each(values, path)
    return into


def decoded(message: Message, data: numpy.ndarray) -> list[numpy.ndarray]:
    """The numbers of messages, an array for each, from their bytes."""
    records = data.view(_layout(message)).reshape(-1)
    return [records[f"f{position}"] for position in range(len(message.codes))]


def _layout(message: Message) -> Any:
    import numpy

    return numpy.dtype(
        {
            "names": [f"f{position}" for position in range(len(message.codes))],
            "formats": list(message.codes),
            "offsets": [len(_HEADER) + offset for offset in message.offsets],
            "itemsize": message.size,
        }
    )


def _code(kind: Type) -> str:
    match kind:
        case BoolType():
            return "|u1"
        case IntType(bits=bits, signed=signed):
            return f"{'|' if bits == 8 else '<'}{'i' if signed else 'u'}{bits // 8}"
        case RealType(bits=bits):
            return f"<f{bits // 8}"
        case TimeType():
            return "<i8"
        case EnumType():
            return "<i4"
        case StructType() | ArrayType() | TextType() | UnknownType():
            raise ValueError(f"{kind} is not one number")
        case _:
            assert_never(kind)


def _primitive(kind: Type) -> str:
    match kind:
        case BoolType():
            return "bool"
        case IntType(bits=bits, signed=signed):
            return f"{'' if signed else 'u'}int{bits}"
        case RealType(bits=bits):
            return f"float{bits}"
        case TimeType():
            return "int64"
        case EnumType():
            return "int32"
        case StructType() | ArrayType() | TextType() | UnknownType():
            raise ValueError(f"{kind} is not one number")
        case _:
            assert_never(kind)


def _named(kind: Type, found: dict[str, str]) -> str:
    """The short name of the message of a type, whose definition and those that it needs are added, itself first."""
    match kind:
        case BoolType() | IntType() | RealType() | TimeType():
            name = f"std_msgs/{_primitive(kind).capitalize().replace('Uint', 'UInt')}"
            found.setdefault(name, f"{_primitive(kind)} data{_comment(kind)}\n")
        case EnumType(name=own, literals=literals):
            name = f"{_PACKAGE}/{_camel(own)}"
            constants = "".join(f"int32 {literal.upper()}={index}\n" for index, literal in enumerate(literals))
            found.setdefault(name, f"{constants}int32 data\n")
        case StructType(name=own, fields=fields):
            name = f"{_PACKAGE}/{_camel(own)}"
            if name not in found:
                found[name] = ""
                found[name] = "".join(f"{_field(field, inner, found)}\n" for field, inner in fields)
        case ArrayType(element=element, size=size):
            name = f"{_PACKAGE}/{_array_name(kind)}"
            if name not in found:
                found[name] = ""
                found[name] = f"{_field('data', ArrayType(element, size), found)}\n"
        case TextType() | UnknownType():
            raise ValueError(f"no port has the type {kind}")
        case _:
            assert_never(kind)
    return name


def _field(name: str, kind: Type, found: dict[str, str]) -> str:
    match kind:
        case ArrayType(element=element, size=size) if not isinstance(element, ArrayType):
            inner = _field(name, element, found)
            type_, _, rest = inner.partition(" ")
            return f"{type_}[{size}] {rest}"
        case ArrayType(element=element, size=size):
            return f"{_named(element, found)}[{size}] {_snake(name)}"
        case StructType():
            return f"{_named(kind, found)} {_snake(name)}"
        case BoolType() | IntType() | RealType() | TimeType() | EnumType() | TextType() | UnknownType():
            return f"{_primitive(kind)} {_snake(name)}{_comment(kind)}"
        case _:
            assert_never(kind)


def _comment(kind: Type) -> str:
    """What a definition says of a number: its unit, or its literals."""
    if isinstance(kind, RealType):
        return f"  # {kind.unit}"
    if isinstance(kind, TimeType):
        return "  # ns"
    return f"  # {', '.join(kind.literals)}" if isinstance(kind, EnumType) else ""


def _array_name(kind: Type) -> str:
    if isinstance(kind, ArrayType):
        return f"{_array_name(kind.element)}x{kind.size}"
    return _camel(kind.name) if isinstance(kind, EnumType | StructType) else _camel(_primitive(kind))


def _camel(name: str) -> str:
    return "".join(part[:1].upper() + part[1:] for part in re.split(r"[^A-Za-z0-9]+", name)) or "Message"


def _snake(name: str) -> str:
    """A name as fields of messages have it: lower case, words separated by single underscores."""
    return re.sub(r"_+", "_", re.sub(r"(?<=[a-z0-9])([A-Z])", r"_\1", name)).strip("_").lower() or "field"


def _full(name: str) -> str:
    package, _, rest = name.partition("/")
    return f"{package}/msg/{rest}"


def topics(names: Sequence[str]) -> list[str]:
    """The topic of each port: ``gyro[0]`` is ``/gyro_0``."""
    return ["/" + re.sub(r"_+", "_", re.sub(r"[^A-Za-z0-9_]+", "_", name)).strip("_") for name in names]
