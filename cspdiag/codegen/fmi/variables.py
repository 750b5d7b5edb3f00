"""The variables of an FMU: the ports, each scalar of a struct or an array by itself."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal, TypeAlias, assert_never

from cspdiag.base.record import record
from cspdiag.codegen.c.text.types import CTypes
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

Causality: TypeAlias = Literal["input", "output", "parameter"]

Scalar: TypeAlias = BoolType | IntType | RealType | TimeType | EnumType


@record(kw_only=True)
class Clock:
    """The type of a clock, which an event has in FMI 3.0; in FMI 2.0 a number counts the events."""


@record(kw_only=True)
class Variable:
    """A variable: its name in FMI, its place in the struct of the model, and its value at the start.

    ``is_delayed``: an output that does not depend on the inputs of the same instant. ``is_fixed``: a parameter that may
    be set until the initialization ends.
    """

    name: str
    causality: Causality
    type: Scalar | Clock
    place: str
    start: Value
    description: str = ""
    is_delayed: bool = False
    is_fixed: bool = False

    @property
    def unit(self) -> str:
        """The unit, as the program spells it; empty for none."""
        if isinstance(self.type, TimeType):
            return "s"
        return self.type.unit.text if isinstance(self.type, RealType) else ""


def scalars(
    name: str, place: str, type_: Type, value: Value, types: CTypes
) -> Iterator[tuple[str, str, Scalar, Value]]:
    """The scalars of a value: name, place in C, type and value of each."""
    match type_:
        case StructType(fields=fields):
            assert isinstance(value, tuple)
            for (field, kind), part in zip(fields, value, strict=True):
                yield from scalars(f"{name}.{field}", f"{place}.{types.field(field)}", kind, part, types)
        case ArrayType(element=element):
            assert isinstance(value, tuple)
            for index, part in enumerate(value):
                yield from scalars(_indexed(name, index), f"{place}.at[{index}]", element, part, types)
        case BoolType() | IntType() | RealType() | TimeType() | EnumType():
            yield name, place, type_, value
        case TextType() | UnknownType():
            raise ValueError(f"{type_} has no values at run time")
        case _:
            assert_never(type_)


def _indexed(name: str, index: int) -> str:
    """The name of an element; FMI writes the indexes of an array of arrays as ``grid[0,1]``."""
    return f"{name.removesuffix(']')},{index}]" if name.endswith("]") else f"{name}[{index}]"


def c_type(type_: Scalar | Clock) -> str:
    """The name of the type in ``fmu.h``."""
    match type_:
        case BoolType():
            return "FMU_BOOLEAN"
        case IntType():
            return f"FMU_{'' if type_.signed else 'U'}INT{type_.bits}"
        case RealType():
            return f"FMU_FLOAT{type_.bits}"
        case TimeType():
            return "FMU_TIME"
        case EnumType():
            return "FMU_ENUMERATION"
        case Clock():
            return "FMU_CLOCK"
    assert_never(type_)
