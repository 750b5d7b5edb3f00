"""Recordings and the plain trace as text."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, BinaryIO, assert_never

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
from cspdiag.simulate.record.run_data import histories, signal_of

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


def csv_parts(run: RunData) -> Iterator[str]:
    """A header, then a row for each instant at which an external port had a new value; values are held in between.

    Arrays and structs have a column for each of their numbers. Parts of the text, one after the other, because the
    whole may be longer than the memory has room for.
    """
    columns = [
        column
        for port in run.network.external_ports
        for column in columns_of(f"{run.network.top}.{port.name}", port.name, port.type, written)
    ]
    yield ",".join(["time", *(column.name for column in columns)]) + "\n"
    for instants, cells in held_rows(histories(run), columns, ""):
        times = [repr(instant / 1e9) for instant in instants]
        yield "\n".join(map(",".join, zip(times, *cells, strict=True))) + "\n"


def written(values: list[Any], kind: Type) -> list[str]:
    """Numbers as written in a table."""
    match kind:
        case BoolType():
            return ["true" if value else "false" for value in values]
        case EnumType(literals=literals):
            return [literals[int(value)] for value in values]
        case RealType():
            return list(map(repr, values))  # The shortest text that is read as the same number.
        case IntType() | TimeType() | TextType() | StructType() | ArrayType() | UnknownType():
            return list(map(str, values))
        case _:
            assert_never(kind)


def write_npz(run: RunData, file: BinaryIO) -> None:
    """For each external port ``NAME`` its values, as ``Signal`` has them, and ``NAME.time`` its instants in seconds.

    Arrays are not compressed: that would take far longer than the run of a native program.
    """
    from zipfile import ZipFile

    from numpy.lib.format import write_array

    with ZipFile(file, "w") as archive:
        for port in run.network.external_ports:
            signal = signal_of(run, port)
            for name, array in ((port.name, signal.value), (f"{port.name}.time", signal.time)):
                with archive.open(f"{name}.npy", "w", force_zip64=True) as entry:
                    write_array(entry, array, allow_pickle=False)
