"""Values of enums and structs as members of classes, as generated Python has them, for runs on other targets."""

from __future__ import annotations

from collections import namedtuple
from collections.abc import Callable
from enum import IntEnum
from functools import cache
from typing import Any, assert_never

from cspdiag.codegen.python.text.types import enum_members, field_names
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

InClasses = Callable[[Any], Any]


@cache
def in_classes(type_: Type) -> InClasses | None:
    """What makes a value, with numbers for enums and tuples for structs, one of classes with the names of the program:
    an ``IntEnum``, a ``NamedTuple``. None for a type without such parts. Such a value remains as it is.
    """
    match type_:
        case EnumType():
            return _in_enum(type_)
        case StructType():
            return _in_struct(type_)
        case ArrayType(element=element):
            part = in_classes(element)
            return None if part is None else lambda value: tuple(map(part, value))
        case BoolType() | IntType() | RealType() | TimeType() | TextType() | UnknownType():
            return None
        case _:
            assert_never(type_)


def _in_enum(type_: EnumType) -> InClasses:
    members = enum_members(type_)
    names = [(members[literal], number) for number, literal in enumerate(type_.literals)]
    make: Any = IntEnum
    enum = make(type_.name, names)
    return lambda value: value if isinstance(value, IntEnum) else enum(value)


def _in_struct(type_: StructType) -> InClasses:
    names = field_names(type_)
    make: Any = namedtuple
    made = make(type_.name, [names[name] for name, _ in type_.fields])
    parts = [in_classes(kind) for _, kind in type_.fields]

    def converted(value: Any) -> Any:
        if hasattr(value, "_fields"):
            return value
        return made(*[entry if part is None else part(entry) for part, entry in zip(parts, value, strict=True)])

    return converted
