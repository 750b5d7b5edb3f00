"""Values of ports and parameters between a program and a page."""

from __future__ import annotations

from math import isfinite
from typing import Any, assert_never

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
from cspdiag.simulate.record.leaves import leaf, leaves
from cspdiag.studio.engine.data import Data, number, plain
from cspdiag.studio.engine.failure import RequestError


def about(kind: Type) -> Data:
    """The type of a number, as the page shows it."""
    return {
        "type": str(kind),
        "unit": (str(kind.unit) or None) if isinstance(kind, RealType) else None,
        "literals": list(kind.literals) if isinstance(kind, EnumType) else None,
    }


def shown_values(values: list[Any], kind: Type) -> list[Any]:
    """Numbers of one type: literals of an enum by name, what is not finite is null."""
    if isinstance(kind, EnumType):
        return [kind.literals[int(value)] for value in values]
    if isinstance(kind, BoolType):
        return [bool(value) for value in values]
    return [number(value) for value in values] if isinstance(kind, RealType) else values


def value_data(value: Any, kind: Type | None) -> Any:
    """A value as JSON has it: structs as objects, arrays as lists, literals by name."""
    match kind:
        case EnumType(literals=literals):
            return literals[int(value)]
        case StructType(fields=fields):
            return {name: value_data(part, inner) for (name, inner), part in zip(fields, value, strict=True)}
        case ArrayType(element=element):
            return [value_data(part, element) for part in value]
        case BoolType() | IntType() | RealType() | TimeType() | TextType() | UnknownType() | None:
            return plain(value)
        case _:
            assert_never(kind)


def fields(name: str, kind: Type, value: Any) -> list[Data]:
    """The numbers that a value consists of, under the names by which a parameter is changed."""
    return [
        {"name": full, **about(inner), "value": value_data(leaf(value, path), inner)}
        for full, inner, path in leaves(name, kind)
    ]


def number_of(name: str, kind: Type, value: Any) -> Any:
    """A number for an input of this type. Raises RequestError for a value that the type does not have."""
    match kind:
        case BoolType():
            if isinstance(value, bool):
                return value
        case RealType():
            if not isinstance(value, bool) and isinstance(value, int | float) and isfinite(value):
                return float(value)
        case IntType():
            if _is_whole(value) and kind.minimum <= value <= kind.maximum:
                return int(value)
        case TimeType():
            if _is_whole(value) and abs(value) < 1 << 63:
                return int(value)
        case EnumType(literals=literals):
            if value in literals:
                return literals.index(value)
        case ArrayType() | StructType() | TextType() | UnknownType():
            pass
        case _:
            assert_never(kind)
    raise RequestError(f"{value!r} is not a value of the input `{name}`, which is {kind}")


def _is_whole(value: Any) -> bool:
    return not isinstance(value, bool) and isinstance(value, int | float) and isfinite(value) and value == int(value)
