"""Values of C programs as Python values: the layout of the types in the memory of this machine."""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, assert_never

from cspdiag.base.errors import CspdiagError
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

if TYPE_CHECKING:
    import numpy

Decoder = Callable[[bytes], object]


class NoEnumeratorError(CspdiagError):
    """A number that a driver in C has given is that of no value of its enumeration."""

    def __init__(self, type_: EnumType, number: int) -> None:
        super().__init__(
            f"a value of {type_.name} has the number {number}, which is that of none of its values: only a driver that "
            "is written in C can have given it"
        )


def layout(type_: Type) -> tuple[int, int]:
    """Size and alignment in bytes, of this machine's C compilers."""
    match type_:
        case StructType() | ArrayType():
            size, alignment = 0, 1
            for part in _parts(type_):
                inner, aligned = layout(part)
                size, alignment = -(-size // aligned) * aligned + inner, max(alignment, aligned)
            return -(-size // alignment) * alignment, alignment
        case BoolType() | IntType() | RealType() | TimeType() | TextType() | EnumType() | UnknownType():
            size = struct.calcsize(letter_of(type_))
            return size, size
        case _:
            assert_never(type_)


def decoder(type_: Type) -> Decoder:
    """A function that decodes a value from its bytes: bool, int, float, and tuples for structs and arrays. It raises
    NoEnumeratorError.
    """
    if not isinstance(type_, StructType | ArrayType):
        single = struct.Struct(f"={letter_of(type_)}")
        if isinstance(type_, BoolType):
            return lambda data: data != b"\0"
        if isinstance(type_, EnumType):
            return lambda data: _enumerator(type_, single.unpack(data)[0])
        return lambda data: single.unpack(data)[0]
    pieces: list[tuple[slice, Decoder]] = []
    position = 0
    for part in _parts(type_):
        size, alignment = layout(part)
        position = -(-position // alignment) * alignment
        pieces.append((slice(position, position + size), decoder(part)))
        position += size
    return lambda data: tuple(decode(data[place]) for place, decode in pieces)


def _enumerator(type_: EnumType, number: int) -> int:
    if not 0 <= number < len(type_.literals):
        raise NoEnumeratorError(type_, number)
    return number


def require_enumerators(type_: Type, values: numpy.ndarray) -> None:
    """Raises NoEnumeratorError if a part of the values, which are as in memory, is no value of its enumeration."""
    match type_:
        case EnumType():
            for number in (values.min(), values.max()) if values.size else ():
                _enumerator(type_, int(number))
        case StructType(fields=fields):
            for name, kind in fields:
                require_enumerators(kind, values[name])
        case ArrayType(element=element):
            require_enumerators(element, values)
        case BoolType() | IntType() | RealType() | TimeType() | TextType() | UnknownType():
            return
        case _:
            assert_never(type_)


def encoded(type_: Type, value: Any) -> bytes:
    """The bytes of a value: bool, int, float, or a sequence for a struct or an array."""
    if not isinstance(type_, StructType | ArrayType):
        return struct.pack(f"={letter_of(type_)}", value)
    data = bytearray()
    for part, inner in zip(_parts(type_), value, strict=True):
        _, alignment = layout(part)
        data += bytes(-len(data) % alignment) + encoded(part, inner)
    return bytes(data) + bytes(layout(type_)[0] - len(data))


def offset_of(type_: Type, path: Sequence[int]) -> int:
    """Where the part at a path of positions begins."""
    offset = 0
    for position in path:
        assert isinstance(type_, StructType | ArrayType)
        parts = _parts(type_)
        within = 0
        for part in parts[: position + 1]:
            size, alignment = layout(part)
            within = -(-within // alignment) * alignment + size
        offset += within - layout(parts[position])[0]
        type_ = parts[position]
    return offset


def type_at(type_: Type, path: Sequence[int]) -> Type:
    """The type of the part at a path of positions."""
    for position in path:
        assert isinstance(type_, StructType | ArrayType)
        type_ = _parts(type_)[position]
    return type_


def numpy_type(type_: Type) -> numpy.dtype:
    """The type of numpy for values as they are in memory; those of arrays have a shape."""
    import numpy

    if isinstance(type_, ArrayType):
        return numpy.dtype((numpy_type(type_.element), (type_.size or 0,)))
    if isinstance(type_, StructType):
        return numpy.dtype([(name, numpy_type(kind)) for name, kind in type_.fields], align=True)
    return numpy.dtype(f"={letter_of(type_)}")


def _parts(type_: StructType | ArrayType) -> list[Type]:
    if isinstance(type_, StructType):
        return [field for _, field in type_.fields]
    return [type_.element] * (type_.size or 0)


def letter_of(type_: Type) -> str:
    """The letter of the module ``struct`` for a type that is one number."""
    match type_:
        case BoolType():
            return "?"
        case IntType():
            letter = {8: "b", 16: "h", 32: "i", 64: "q"}[type_.bits]
            return letter if type_.signed else letter.upper()
        case TimeType():
            return "q"
        case RealType():
            return "d" if type_.bits == 64 else "f"
        case EnumType():
            return "i"
        case StructType() | ArrayType() | TextType() | UnknownType():
            raise ValueError(f"{type_} is not one number")
    assert_never(type_)
