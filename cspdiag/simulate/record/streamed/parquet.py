"""Parquet files of stored recordings, by pyarrow: a row for each instant at which a port had a new value, and no value
in the columns of the others, so that events and samples stay what they are.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
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
from cspdiag.simulate.record.leaves import leaf_of_each, leaves
from cspdiag.simulate.record.stored.described import head_data
from cspdiag.simulate.record.stored.recording import StoredRecording
from cspdiag.simulate.record.streamed.archive import Stream
from cspdiag.simulate.record.streamed.part_file import PartFile

if TYPE_CHECKING:
    import numpy

    from cspdiag.simulate.record.streamed.blocks import Block

_ROWS = 1 << 16
"""The least rows of a group of rows."""


def write_parquet(recording: StoredRecording, file: PartFile) -> None:
    """``time`` in nanoseconds, and a column for each number of each port; types and units are in the metadata."""
    import pyarrow
    from pyarrow import parquet

    columns = [
        (position, name, kind, path)
        for position, port in enumerate(recording.head.ports)
        for name, kind, path in leaves(port.name, port.type)
    ]
    about = {"cspdiag": head_data(recording.head), "ended": recording.ended, "time": recording.time}
    fields = [pyarrow.field("time", pyarrow.int64(), nullable=False, metadata={"unit": "ns"})]
    fields += [pyarrow.field(name, _type(kind), metadata=_facts(kind)) for _, name, kind, _ in columns]
    schema = pyarrow.schema(fields, metadata={"cspdiag": json.dumps(about)})
    output = pyarrow.PythonFile(Stream(file), mode="w")
    with parquet.ParquetWriter(output, schema, write_page_checksum=True) as writer:
        for parts in _groups(recording):
            tables = []
            for blocks in parts:
                time, places = _rows(blocks)
                arrays: list[Any] = [pyarrow.array(time)]
                for position, _, kind, path in columns:
                    found = [
                        (places[at], leaf_of_each(block.value, path))
                        for at, block in enumerate(blocks)
                        if block.port == position
                    ]
                    arrays.append(_column(len(time), found, kind))
                tables.append(pyarrow.table(arrays, schema=schema))
            writer.write_table(pyarrow.concat_tables(tables))


def _groups(recording: StoredRecording) -> Iterator[list[Sequence[Block]]]:
    """Parts of the recording, together for a group of rows."""
    parts: list[Sequence[Block]] = []
    count = 0
    for blocks in recording.blocks():
        if blocks:
            parts.append(blocks)
            count += max(len(block.time) for block in blocks)
        if count >= _ROWS:
            yield parts
            parts, count = [], 0
    if parts:
        yield parts


def _rows(blocks: Sequence[Block]) -> tuple[numpy.ndarray, list[numpy.ndarray]]:
    """The instants of the rows, and the row of each value of each block: a row for each instant, and more if a port had
    several values at one.
    """
    import numpy

    repeats = [_repeats(block.time) for block in blocks]
    most = 1 + max(int(repeated.max()) for repeated in repeats)
    begin = min(int(block.time[0]) for block in blocks)
    keys = [(block.time - begin) * most + repeated for block, repeated in zip(blocks, repeats, strict=True)]
    rows = numpy.unique(numpy.concatenate(keys))
    return rows // most + begin, [numpy.searchsorted(rows, own) for own in keys]


def _repeats(time: numpy.ndarray) -> numpy.ndarray:
    """How many values of the same instant come before each."""
    import numpy

    positions = numpy.arange(len(time))
    is_new = numpy.concatenate([[True], time[1:] != time[:-1]])
    repeated: numpy.ndarray = positions - numpy.maximum.accumulate(numpy.where(is_new, positions, 0))
    return repeated


def _column(count: int, found: Sequence[tuple[numpy.ndarray, Any]], kind: Type) -> Any:
    import numpy
    import pyarrow

    missing = numpy.ones(count, bool)
    values: numpy.ndarray = numpy.zeros(count, bool if isinstance(kind, BoolType) else _number(kind))
    for places, own in found:
        missing[places] = False
        values[places] = own
    if isinstance(kind, EnumType):
        codes = pyarrow.array(values, mask=missing, type=pyarrow.int32())
        return pyarrow.DictionaryArray.from_arrays(codes, pyarrow.array(list(kind.literals)))
    return pyarrow.array(values, mask=missing, type=_type(kind))


def _number(kind: Type) -> str:
    match kind:
        case IntType(bits=bits, signed=signed):
            return f"{'i' if signed else 'u'}{bits // 8}"
        case RealType(bits=bits):
            return f"f{bits // 8}"
        case TimeType():
            return "i8"
        case EnumType():
            return "i4"
        case BoolType() | StructType() | ArrayType() | TextType() | UnknownType():
            raise ValueError(f"{kind} is not a number")
        case _:
            assert_never(kind)


def _type(kind: Type) -> Any:
    import pyarrow

    if isinstance(kind, EnumType):
        return pyarrow.dictionary(pyarrow.int32(), pyarrow.string())
    return pyarrow.bool_() if isinstance(kind, BoolType) else pyarrow.from_numpy_dtype(_number(kind))


def _facts(kind: Type) -> dict[str, str]:
    unit = {"unit": str(kind.unit)} if isinstance(kind, RealType) else {}
    return {"type": str(kind), **unit, **({"unit": "ns"} if isinstance(kind, TimeType) else {})}
