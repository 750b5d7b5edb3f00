"""Types and values of a program that computes in single precision, and of the environment around it."""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.model.constants.arithmetic import single
from cspdiag.model.types import ArrayType, RealType, StructType, Type, is_single
from cspdiag.network.ir.expressions import Value


def program_type(kind: Type) -> Type:
    """The type of values in the program for a type of the text: its reals are in single precision."""
    if isinstance(kind, RealType):
        return RealType(32, kind.unit)
    if isinstance(kind, ArrayType):
        return ArrayType(program_type(kind.element), kind.size)
    if isinstance(kind, StructType):
        return StructType(kind.name, tuple((name, program_type(field)) for name, field in kind.fields))
    return kind


def outside_type(kind: Type) -> Type:
    """The type of values outside the program for a type of the text: its structs are those of the program."""
    if isinstance(kind, ArrayType):
        return ArrayType(outside_type(kind.element), kind.size)
    return program_type(kind) if isinstance(kind, StructType) else kind


def rounded_to(kind: Type, value: Value) -> Value:
    """A value with its reals rounded as the type says, which may make them infinite or zero."""
    if is_single(kind):
        assert isinstance(value, int | float)
        return single(value)
    if isinstance(value, tuple):
        return tuple(rounded_to(inner, part) for inner, part in parts_of(kind, value))
    return value


def parts_of(kind: Type, value: tuple[Value, ...]) -> Iterator[tuple[Type, Value]]:
    """The elements or fields of a value, each with its type."""
    if isinstance(kind, StructType):
        yield from zip((field for _, field in kind.fields), value, strict=True)
    else:
        assert isinstance(kind, ArrayType)
        yield from ((kind.element, element) for element in value)
