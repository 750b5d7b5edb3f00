"""C types, zeros and literals for the types and values of the network representation."""

from __future__ import annotations

import math
import re
import struct
from collections.abc import Iterator
from typing import assert_never

from cspdiag.base import Span
from cspdiag.codegen.c.text.code import CSP, PRODUCT, Aggregate, Atom, Code, call, cast, code, infix, minus
from cspdiag.codegen.c.text.literals import quoted
from cspdiag.codegen.c.text.names import PackageNames, member_name
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
from cspdiag.network.ir.network import ClassParameter

_UNITS = (("CSP_S", 1_000_000_000), ("CSP_MS", 1_000_000), ("CSP_US", 1_000))
_INT_MAXIMUM = 2**31 - 1


class CTypes:
    """The C types of a package. Values of every type can be assigned, passed and returned: an array is a struct with
    one member ``at``.
    """

    def __init__(self, names: PackageNames) -> None:
        self.names = names
        self._arrays: dict[tuple[str, int], tuple[str, ArrayType]] = {}

    def type_name(self, type_: Type) -> str:
        """The C type: ``double``, ``struct tank_pose``, ``enum tank_mode``, ``struct tank_double_4``."""
        match type_:
            case BoolType():
                return "bool"
            case IntType():
                return f"{'' if type_.signed else 'u'}int{type_.bits}_t"
            case TimeType():
                return "int64_t"
            case RealType(bits=32):
                return "float"
            case RealType():
                return "double"
            case EnumType():
                return f"enum {self.names.types[type_.name]}"
            case StructType():
                return f"struct {self.names.types[type_.name]}"
            case ArrayType():
                return f"struct {self._array(type_)}"
            case TextType() | UnknownType():
                raise ValueError(f"{type_} has no C type")
        assert_never(type_)

    def suffix(self, type_: Type) -> str:
        """The part of names of functions that is for a type: ``tank_pose``, ``tank_double_4``, ``int8``."""
        word, _, name = self.type_name(type_).rpartition(" ")
        return name if word else name.removesuffix("_t")

    def _array(self, type_: ArrayType) -> str:
        size = type_.size or 0
        key = (self.type_name(type_.element), size)
        if key not in self._arrays:
            element = self.suffix(type_.element).removeprefix(f"{self.names.prefix}_")
            self._arrays[key] = (self.names.public(f"{element}_{size}"), type_)
        return self._arrays[key][0]

    @property
    def arrays(self) -> list[ArrayType]:
        """The array types that have been named so far, inner ones first."""
        return [type_ for _, type_ in self._arrays.values()]

    def field(self, name: str) -> str:
        """The member for a field of a struct."""
        return f"{member_name(name)}_" if name.rstrip("_") in self.names.macros else member_name(name)

    def literal(self, value: Value, type_: Type, span: Span | None = None) -> Code:
        """A value as an expression; numbers are spelled as in the source text at ``span``."""
        match type_:
            case BoolType():
                return Atom("true" if value else "false")
            case IntType():
                assert isinstance(value, int)
                return integer(value)
            case TimeType():
                assert isinstance(value, int)
                return duration(value)
            case RealType():
                assert isinstance(value, int | float)
                return real(float(value), type_.bits, span)
            case EnumType():
                assert isinstance(value, int)
                return Atom(self.names.literals[type_.name][value])
            case StructType() | ArrayType():
                return Aggregate(self.initializer(value, type_).parts, self.type_name(type_))
            case TextType() | UnknownType():
                raise ValueError(f"{type_} has no literals in C")
        assert_never(type_)

    def parameter(self, parameter: ClassParameter, name: str) -> str:
        """The declaration of a parameter of a class: a pointer, if it refers to a parameter of the program."""
        type_name = self.type_name(parameter.type)
        return f"const {type_name} *{name}" if parameter.tunable else f"{type_name} {name}"

    def initial(self, value: Value, type_: Type) -> Code:
        """A value as the initializer of a definition, which may be static."""
        return (
            self.initializer(value, type_) if isinstance(type_, StructType | ArrayType) else self.literal(value, type_)
        )

    def initializer(self, value: Value, type_: StructType | ArrayType) -> Aggregate:
        """The same for a struct or an array."""
        assert isinstance(value, tuple)
        if isinstance(type_, StructType):
            fields = zip(type_.fields, value, strict=True)
            return Aggregate(tuple((f".{self.field(name)}", self.initial(part, kind)) for (name, kind), part in fields))
        return Aggregate(((None, Aggregate(tuple((None, self.initial(part, type_.element)) for part in value))),))

    def has_reals(self, type_: Type) -> bool:
        """Whether values of a type contain real numbers, which may be NaN."""
        return any(isinstance(part, RealType) for part in scalars(type_))

    def finite_check(self, type_: Type, value: Code, port: Code) -> Code | None:
        """A call that notes a fault if a part of the value that is written to an external output is NaN or infinite;
        None for types without real numbers.

        ``port`` is the name of the port as a string.
        """
        if not self.has_reals(type_):
            return None
        if isinstance(type_, RealType):
            return call("csp_finite_single" if type_.bits == 32 else "csp_finite", value, port)
        return call(f"{self.suffix(type_)}_finite", CSP, value, port)

    def enumerator_checks(self, type_: Type, value: Code) -> Iterator[Code]:
        """Calls that note a fault if a part of a value that was calculated by hand is no value of its enumeration."""
        match type_:
            case EnumType():
                known = (integer(len(type_.literals)), code(quoted(type_.name)))
                yield call("csp_enumerator", cast("int64_t", value), *known)
            case StructType(fields=fields):
                for name, field in fields:
                    yield from self.enumerator_checks(field, value.field(self.field(name)))
            case ArrayType(element=element):
                for position in range(type_.size or 0):
                    yield from self.enumerator_checks(element, value.field("at").at(integer(position)))
            case BoolType() | IntType() | RealType() | TimeType() | TextType() | UnknownType():
                return
            case _:
                assert_never(type_)


def scalars(type_: Type) -> Iterator[Type]:
    """The types of the scalars that a value consists of."""
    match type_:
        case StructType(fields=fields):
            for _, field in fields:
                yield from scalars(field)
        case ArrayType(element=element):
            yield from scalars(element)
        case BoolType() | IntType() | RealType() | TimeType() | TextType() | EnumType() | UnknownType():
            yield type_
        case _:
            assert_never(type_)


def integer(value: int) -> Code:
    """An integer literal, with an explicit type if it does not fit in 32 bits."""
    if value == -(2**63):
        return Atom("INT64_MIN")
    number = Atom(str(abs(value)) if abs(value) <= _INT_MAXIMUM else f"INT64_C({abs(value)})")
    return minus(number) if value < 0 else number


def duration(nanoseconds: int) -> Code:
    """A duration in its largest unit: ``CSP_S``, ``2 * CSP_MS``."""
    for unit, size in _UNITS:
        if nanoseconds != 0 and nanoseconds % size == 0:
            count = nanoseconds // size
            return Atom(unit) if count == 1 else infix("*", PRODUCT, integer(count), Atom(unit))
    return integer(nanoseconds)


def real(value: float, bits: int = 64, span: Span | None = None) -> Code:
    """A literal for exactly this real number, spelled as in the source text if that has the same value."""
    if math.isnan(value):
        return cast("float" if bits == 32 else "double", Atom("NAN"))
    if math.copysign(1.0, value) < 0:
        return minus(_positive(-value, bits, "" if span is None else span.text.removeprefix("-")))
    return _positive(value, bits, "" if span is None else span.text)


def _positive(value: float, bits: int, text: str) -> Code:
    if math.isinf(value):
        return Atom("INFINITY") if bits == 32 else cast("double", Atom("INFINITY"))
    if bits == 32:
        return _single(value)
    written = re.match(r"\d+\.\d*(e[+-]?\d+)?|\d+e[+-]?\d+", text)
    if written and float(written[0]) == value and not written[0].endswith("."):
        return Atom(written[0])
    return Atom(repr(value))


def _single(value: float) -> Code:
    """A binary32 literal with as few digits as possible."""
    try:
        rounded = struct.unpack("<f", struct.pack("<f", value))[0]
    except OverflowError:
        return Atom("INFINITY")
    text = next(
        (text for text in (f"{rounded:.{digits}g}" for digits in range(1, 10)) if _as_single(text) == rounded),
        repr(rounded),
    )
    if "." not in text and "e" not in text:
        text += ".0"
    return Atom(f"{text}f")


def _as_single(text: str) -> float | None:
    try:
        return float(struct.unpack("<f", struct.pack("<f", float(text)))[0])
    except OverflowError:
        return None
