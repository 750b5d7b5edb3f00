"""The types of values, after names are resolved and sizes are known.

Types compare by value. ``UnknownType`` is the type of expressions with a mistake that was already reported: it agrees
with every type, so nothing is reported twice.
"""

from __future__ import annotations

from typing import Literal, TypeAlias

from cspdiag.base.record import record
from cspdiag.model.units import DIMENSIONLESS, Unit


@record
class BoolType:
    """``bool``."""

    def __str__(self) -> str:
        return "bool"


@record
class IntType:
    """``int`` (64 bits, signed), ``int8`` ... ``uint32``."""

    bits: int = 64
    signed: bool = True

    @property
    def minimum(self) -> int:
        """Smallest value."""
        return -(1 << self.bits - 1) if self.signed else 0

    @property
    def maximum(self) -> int:
        """Largest value."""
        return (1 << self.bits - 1) - 1 if self.signed else (1 << self.bits) - 1

    def __str__(self) -> str:
        return "int" if self.bits == 64 else f"{'' if self.signed else 'u'}int{self.bits}"


@record
class RealType:
    """``double`` (IEEE 754 binary64) or ``float`` (binary32), with a unit."""

    bits: int = 64
    unit: Unit = DIMENSIONLESS

    def __str__(self) -> str:
        name = "double" if self.bits == 64 else "float"
        return name if self.unit == DIMENSIONLESS else f"{name}<{self.unit}>"


def is_single(kind: Type) -> bool:
    """Whether a type is that of reals in binary32."""
    return isinstance(kind, RealType) and kind.bits == 32


def has_real(kind: Type) -> bool:
    """Whether values of a type have a real."""
    if isinstance(kind, ArrayType):
        return has_real(kind.element)
    if isinstance(kind, StructType):
        return any(has_real(field) for _, field in kind.fields)
    return isinstance(kind, RealType)


def has_single(kind: Type) -> bool:
    """Whether values of a type have a real in binary32."""
    if isinstance(kind, ArrayType):
        return has_single(kind.element)
    if isinstance(kind, StructType):
        return any(has_single(field) for _, field in kind.fields)
    return is_single(kind)


def is_double(kind: Type) -> bool:
    """Whether a type is that of reals in binary64."""
    return isinstance(kind, RealType) and kind.bits == 64


@record
class TimeType:
    """``time``: a duration in integer nanoseconds."""

    def __str__(self) -> str:
        return "time"


@record
class TextType:
    """A string; only parameters of drivers and external bodies have it."""

    def __str__(self) -> str:
        return "text"


@record
class EnumType:
    """An enumeration; a value is the index of its literal."""

    name: str
    literals: tuple[str, ...]

    def __str__(self) -> str:
        return self.name


@record
class StructType:
    """A record with named, typed fields in order."""

    name: str
    fields: tuple[tuple[str, Type], ...]

    def field(self, name: str) -> Type | None:
        """Type of a field, or None."""
        return dict(self.fields).get(name)

    def __str__(self) -> str:
        return self.name


@record
class ArrayType:
    """``element[size]``; ``size`` is None where it depends on a parameter that is not known yet."""

    element: Type
    size: int | None

    def __str__(self) -> str:
        return f"{self.element}[{'?' if self.size is None else self.size}]"


@record
class UnknownType:
    """The type of expressions with a mistake that was already reported."""

    def __str__(self) -> str:
        return "?"


Type: TypeAlias = BoolType | IntType | RealType | TimeType | TextType | EnumType | StructType | ArrayType | UnknownType

Real: TypeAlias = Literal["double", "float32"]
"""What `double` means in a program: binary64, or binary32."""
REALS: tuple[Real, ...] = ("double", "float32")

BOOL = BoolType()
INT = IntType()
DOUBLE = RealType()
TIME = TimeType()
TEXT = TextType()
UNKNOWN = UnknownType()


def has_unit(type_: Type) -> bool:
    """Whether values of the type are quantities with a unit."""
    return isinstance(type_, RealType) and bool(type_.unit.text)
