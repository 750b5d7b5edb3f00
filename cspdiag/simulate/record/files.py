"""Recordings and the plain trace as text."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping
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
from cspdiag.simulate.record.held import columns_of, held_rows

if TYPE_CHECKING:
    from cspdiag.simulate.record.run_data import RunData


def readable(value: object, kind: Type | None) -> object:
    """A value as JSON shows it: enum literals by name, structs as objects, arrays as lists."""
    match kind:
        case EnumType(literals=literals):
            return literals[int(value)]  # type: ignore[call-overload]
        case StructType(fields=fields):
            values = list(value)  # type: ignore[call-overload]
            return {name: readable(part, inner) for (name, inner), part in zip(fields, values, strict=True)}
        case ArrayType(element=element):
            return [readable(part, element) for part in value]  # type: ignore[attr-defined]
        case BoolType() | IntType() | RealType() | TimeType() | TextType() | UnknownType() | None:
            return value
        case _:
            assert_never(kind)


def plain_trace_text(run: RunData) -> str:
    """One JSON object for each communication, in order: time in nanoseconds, channel, value."""
    types: Mapping[str, Type] = run.types
    lines = [
        json.dumps({"t": time, "channel": channel, "value": readable(value, types.get(channel))})
        for time, channel, value, _, _ in run.communications
    ]
    return "".join(f"{line}\n" for line in lines)


def csv_text(run: RunData) -> str:
    """A header, then a row for each instant at which an external port had a new value; values are held in between.

    Arrays and structs have a column for each of their numbers.
    """
    columns = [
        column
        for port in run.network.external_ports
        for column in columns_of(f"{run.network.top}.{port.name}", port.name, port.type, _written)
    ]
    lines = [",".join(["time", *(column.name for column in columns)])]
    lines += [",".join([repr(instant / 1e9), *row]) for instant, row in held_rows(run, columns, "")]
    return "".join(f"{line}\n" for line in lines)


def _written(value: Any, kind: Type) -> str:
    """A number as written in a table."""
    match kind:
        case BoolType():
            return "true" if value else "false"
        case EnumType(literals=literals):
            return literals[int(value)]
        case IntType() | RealType() | TimeType() | TextType() | StructType() | ArrayType() | UnknownType():
            return str(value)
        case _:
            assert_never(kind)


def npz_bytes(run: RunData) -> bytes:
    """For each external port ``NAME`` its values, as ``Signal`` has them, and ``NAME.time`` its instants in seconds."""
    import numpy

    arrays = {}
    for port in run.network.external_ports:
        signal = run.signals[port.name]
        arrays[port.name] = signal.value
        arrays[f"{port.name}.time"] = signal.time
    buffer = io.BytesIO()
    numpy.savez_compressed(buffer, allow_pickle=False, **arrays)
    return buffer.getvalue()
