"""Python types, zeros and literals for the types and values of the network."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import assert_never

from cspdiag.base import Span
from cspdiag.codegen.python.text.code import (
    FALSE,
    PRODUCT,
    TRUE,
    Code,
    Constant,
    Name,
    WholeNumber,
    call,
    integer,
    number,
    tuple_of,
)
from cspdiag.codegen.python.text.imports import Imports
from cspdiag.codegen.python.text.literals import quoted
from cspdiag.codegen.python.text.names import member_names
from cspdiag.codegen.python.text.operators import infix
from cspdiag.model.constants.arithmetic import single
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

_UNITS = (("s", 1_000_000_000), ("ms", 1_000_000), ("us", 1_000))
_MEMBERS_OF_INT = frozenset(
    [
        "name",
        "value",
        "real",
        "imag",
        "numerator",
        "denominator",
        "conjugate",
        "bit_length",
        "bit_count",
        "to_bytes",
        "from_bytes",
        "is_integer",
        "as_integer_ratio",
        "mro",
    ]
)
_MEMBERS_OF_TUPLE = frozenset(["count", "index"])


def annotation(type_: Type, imports: Imports) -> str:
    """The Python type of values of ``type_``."""
    match type_:
        case BoolType():
            return "bool"
        case IntType() | TimeType():
            return "int"
        case RealType():
            return "float"
        case TextType():
            return "str"
        case EnumType() | StructType():
            return imports.type_(type_.name)
        case ArrayType():
            return f"tuple[{annotation(type_.element, imports)}, ...]"
        case UnknownType():
            raise ValueError("a type that was reported cannot be generated")
    assert_never(type_)


def accepted(type_: Type, imports: Imports) -> Code:
    """The converter that turns what a driver returns into a value of ``type_``."""

    def runtime(name: str) -> Code:
        return Name(imports.runtime(name))

    match type_:
        case BoolType():
            return runtime("boolean")
        case IntType():
            return call(runtime("integer"), runtime(f"{'' if type_.signed else 'u'}int{type_.bits}"))
        case TimeType():
            return call(runtime("integer"), runtime("duration"))
        case RealType():
            return runtime("single" if type_.bits == 32 else "double")
        case TextType():
            return runtime("text")
        case EnumType():
            return call(runtime("enumeration"), Name(imports.type_(type_.name)))
        case StructType():
            fields = [accepted(field, imports) for _, field in type_.fields]
            return call(runtime("record"), Name(imports.type_(type_.name)), *fields)
        case ArrayType():
            return call(runtime("array"), accepted(type_.element, imports), WholeNumber(type_.size or 0))
        case UnknownType():
            raise ValueError("a type that was reported cannot be generated")
    assert_never(type_)


def literal(value: Value, type_: Type, imports: Imports, span: Span | None = None) -> Code:
    """A value as an expert would write it; numbers keep their spelling at ``span``."""
    match type_:
        case BoolType():
            return TRUE if value else FALSE
        case IntType():
            assert isinstance(value, int)
            return integer(int(value))
        case TimeType():
            assert isinstance(value, int)
            return duration(value, imports)
        case RealType():
            assert isinstance(value, int | float)
            return real(single(float(value)) if type_.bits == 32 else float(value), span)
        case TextType():
            return Constant(quoted(str(value)))
        case EnumType():
            assert isinstance(value, int)
            return Name(imports.type_(type_.name)).field(enum_members(type_)[type_.literals[value]])
        case StructType():
            assert isinstance(value, tuple)
            fields = zip(type_.fields, value, strict=True)
            names = field_names(type_)
            named = {names[name]: literal(part, field, imports) for (name, field), part in fields}
            return call(imports.type_(type_.name), **named)
        case ArrayType():
            assert isinstance(value, tuple)
            if len(value) > 8 and len(set(value)) == 1:
                element = tuple_of([literal(value[0], type_.element, imports)])
                return infix("*", PRODUCT, element, WholeNumber(len(value)))
            return tuple_of(literal(part, type_.element, imports) for part in value)
        case UnknownType():
            raise ValueError("a type that was reported cannot be generated")
    assert_never(type_)


def real(value: float, span: Span | None = None) -> Code:
    """A float, in the spelling of the text if that has the same value in Python."""
    if span is not None:
        written = re.match(r"-?\d+\.\d*(e[+-]?\d+)?|-?\d+e[+-]?\d+", span.text)
        if written and float(written[0]) == value and not written[0].endswith("."):
            return number(written[0])
    if value != value:
        return call("float", Constant('"nan"'))
    if value in (float("inf"), float("-inf")):
        return call("float", Constant('"inf"' if value > 0 else '"-inf"'))
    return number(repr(value))


def duration(nanoseconds: int, imports: Imports) -> Code:
    """A duration in its largest unit: ``2 * ms``."""
    if nanoseconds == 0:
        return WholeNumber(0)
    unit, size = next(((unit, size) for unit, size in _UNITS if nanoseconds % size == 0), ("ns", 1))
    return infix("*", PRODUCT, integer(nanoseconds // size), Name(imports.runtime(unit)))


def enum_members(type_: EnumType) -> Mapping[str, str]:
    """The members of an ``IntEnum`` for the literals of an enum."""
    return member_names(type_.literals, _MEMBERS_OF_INT)


def field_names(type_: StructType) -> Mapping[str, str]:
    """The fields of a ``NamedTuple`` for those of a struct."""
    return member_names(tuple(name for name, _ in type_.fields), _MEMBERS_OF_TUPLE)
