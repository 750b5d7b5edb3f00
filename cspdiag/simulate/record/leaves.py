"""Values of arrays and structs as numbers: in columns of their own for people and tables, in one array for numpy."""

from __future__ import annotations

from collections.abc import Iterator
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

if TYPE_CHECKING:
    import numpy

Path = tuple[int, ...]
"""The positions that lead to one number of a value, from the outside in."""


def leaves(name: str, type_: Type) -> Iterator[tuple[str, Type, Path]]:
    """The numbers that a value of a port consists of, with what each is called: ``gyro[0]``, ``pose.x``,
    ``arms[1].angle``.
    """
    match type_:
        case ArrayType(element=element, size=size):
            for index in range(size or 0):
                yield from _inside(f"{name}[{index}]", element, index)
        case StructType(fields=fields):
            for index, (field, kind) in enumerate(fields):
                yield from _inside(f"{name}.{field}", kind, index)
        case BoolType() | IntType() | RealType() | TimeType() | TextType() | EnumType() | UnknownType():
            yield name, type_, ()
        case _:
            assert_never(type_)


def _inside(name: str, type_: Type, index: int) -> Iterator[tuple[str, Type, Path]]:
    for full, kind, path in leaves(name, type_):
        yield full, kind, (index, *path)


def leaf(value: Any, path: Path) -> Any:
    """One number of a value."""
    for index in path:
        value = value[index]
    return value


def leaf_of_each(values: list[Any] | numpy.ndarray, path: Path) -> list[Any] | numpy.ndarray:
    """One number of each value of a list, or of an array as ``column`` makes them."""
    if isinstance(values, list):
        return [leaf(value, path) for value in values] if path else values
    for index in path:
        values = values[:, index] if values.ndim > 1 else values[(values.dtype.names or ())[index]]
    return values


def column(values: list[Any], type_: Type) -> numpy.ndarray:
    """Values as an array of their type: shape ``(n,)``, for arrays ``(n, size)``; structs become numpy structures with
    the same fields.
    """
    import numpy

    found = numpy.empty(len(values), dtype=_dtype(type_))
    if values:
        is_plain = not isinstance(type_, ArrayType | StructType)
        found[:] = values if is_plain else [_plain(value, type_) for value in values]
    return found


def _dtype(type_: Type) -> Any:
    match type_:
        case BoolType():
            return bool
        case IntType() | TimeType() | EnumType():
            return "i8"
        case RealType():
            return float
        case StructType(fields=fields):
            return [(name, *_field(kind)) for name, kind in fields]
        case ArrayType():
            return _field(type_)
        case TextType() | UnknownType():
            return object
        case _:
            assert_never(type_)


def _field(type_: Type) -> tuple[Any, ...]:
    """The type of numpy and, for arrays, the shape."""
    shape: list[int] = []
    while isinstance(type_, ArrayType):
        shape.append(type_.size or 0)
        type_ = type_.element
    return (_dtype(type_), tuple(shape)) if shape else (_dtype(type_),)


def _plain(value: Any, type_: Type) -> Any:
    """A value with lists for arrays and tuples for structs, which is how numpy distinguishes them."""
    match type_:
        case ArrayType(element=element):
            return [_plain(part, element) for part in value]
        case StructType(fields=fields):
            return tuple(_plain(part, kind) for part, (_, kind) in zip(value, fields, strict=True))
        case BoolType() | IntType() | RealType() | TimeType() | TextType() | EnumType() | UnknownType():
            return value
        case _:
            assert_never(type_)
