"""Tables (CSV, Parquet) and archives (npz) of recordings, read."""

from __future__ import annotations

import csv
import json
import os
import zipfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from cspdiag.base.errors import missing_package
from cspdiag.base.record import record
from cspdiag.model.types import (
    BOOL,
    DOUBLE,
    INT,
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
from cspdiag.model.wording import counted
from cspdiag.simulate.record.leaves import leaves
from cspdiag.simulate.record.stored.described import RecordedPort, RecordingHead, head_from
from cspdiag.simulate.record.stored.fitting import NoValueError, as_values
from cspdiag.simulate.record.stored.parameters import PARAMETERS
from cspdiag.simulate.record.stored.recording import RecordingError, StoredRecording, assembled
from cspdiag.simulate.record.streamed.blocks import Block
from cspdiag.simulate.record.streamed.part_file import is_part_name

if TYPE_CHECKING:
    import numpy

_ENCODING = "utf-8-sig"
"""Spreadsheets begin tables with a byte order mark, which this leaves out."""
_ROWS = 1 << 14
"""The rows that are read at a time."""


def open_archive(path: str) -> StoredRecording:
    """The recording in an archive of numpy. Raises RecordingError, and OSError."""
    import numpy

    try:
        with zipfile.ZipFile(path) as entries:
            comment = entries.comment
    except zipfile.BadZipFile as problem:
        raise RecordingError(f"{path} is no archive of numpy, or was cut: {problem}") from None
    head, ended, time = None, "", 0
    if comment:
        about = json.loads(comment)
        head, ended, time = head_from(about["cspdiag"]), about["ended"], about["time"]
    typed = head is not None
    if head is None:
        with _archive(path) as archive:
            names = [name for name in archive.files if f"{name}.time" in archive.files]
            ports = tuple(
                RecordedPort(name, _of_array(archive[name], archive[f"{name}.time"], path, name), "in")
                for name in names
            )
        if not ports:
            raise RecordingError(f"{path} is no recording: it has no array NAME with its instants NAME.time")
        head = RecordingHead("", "", "", ports)

    def read(positions: Sequence[int]) -> Iterator[Sequence[Block]]:
        found = []
        with _archive(path) as archive:
            for position in positions:
                name = head.ports[position].name
                instants = numpy.round(archive[f"{name}.time"] * 1e9).astype(numpy.int64)
                found.append(Block(position, instants, archive[name]))
        yield [block for block in found if len(block.time)]

    last = max((int(block.time[-1]) for part in read(range(len(head.ports))) for block in part), default=0)
    return StoredRecording(path, "archive of numpy", head, read, True, ended, time if typed else last, typed)


@contextmanager
def _archive(path: str) -> Iterator[Any]:
    """The arrays by their names; the file is closed even if numpy cannot read it."""
    import numpy

    with open(path, "rb") as file, numpy.load(file, allow_pickle=False) as archive:
        yield archive


def _of_array(values: Any, instants: Any, path: str, name: str) -> Type:
    """The type of the values in an archive of another program: for each instant a number, or an array of numbers."""
    import numpy

    if instants.ndim != 1 or instants.dtype.kind not in "iuf" or not numpy.isfinite(instants).all():
        raise RecordingError(f"{path}: {name}.time is no array of instants in seconds")
    if values.ndim == 0 or len(values) != len(instants):
        count = 1 if values.ndim == 0 else len(values)
        there = f"{counted(len(instants), 'instant')} {name}.time"
        raise RecordingError(f"{path} has {there}, and {counted(count, 'value')} of {name}")
    if (numpy.diff(instants) < 0).any():
        raise RecordingError(f"{path}: the instants {name}.time are not in their order")
    kind = _of_dtype(values.dtype, path, name)
    for size in reversed(values.shape[1:]):
        kind = ArrayType(kind, size)
    return kind


def _of_dtype(kind: Any, path: str, name: str) -> Type:
    if kind.kind == "b":
        return BOOL
    if kind.kind in "iu":
        return INT
    if kind.kind == "f":
        return DOUBLE
    raise RecordingError(f"{path} does not say of what type {name} is")


def open_table(path: str, ports: Sequence[RecordedPort] | None = None) -> StoredRecording:
    """The recording in a table. Its columns are those of ``ports``, or each is a port, whose type is that of its cells.

    Raises RecordingError, with the line that is wrong, and OSError.
    """
    try:
        with open(path, newline="", encoding=_ENCODING) as file:
            columns = [name.strip() for name in next(csv.reader(file), [])]
            kinds = _guessed(file, columns) if ports is None else {}
    except (UnicodeDecodeError, csv.Error) as problem:
        raise RecordingError(f"{path} is no table: {problem}") from None
    _require_columns(path, columns)
    if ports is None:
        ports = [
            RecordedPort(name, kinds[name], "parameter" if name.startswith(f"{PARAMETERS}.") else "in")
            for name in columns[1:]
        ]
    known = [port for port in ports if all(name in columns for name, _, _ in leaves(port.name, port.type))]
    _require_all_parameters(path, columns, ports, known)
    head = RecordingHead("", "", "", tuple(known))
    reader = _Table(path, columns, head)
    last = 0
    for part in reader.rows():
        last = part[-1].time
    names = tuple(columns[1:])
    return StoredRecording(path, "table", head, reader.read, _is_whole(path), "", last, typed=False, columns=names)


def _require_columns(path: str, columns: Sequence[str]) -> None:
    if not columns or columns[0] != "time":
        reason = "the first column of a recording is `time`"
        for separator, name in ((";", "semicolons"), ("\t", "tabs")):
            if columns and columns[0].startswith(f"time{separator}"):
                reason = f"its cells are separated by {name}: write commas, and points in numbers"
        raise RecordingError(f"{path}:1: is no recording: {reason}")
    for name in columns:
        if columns.count(name) > 1:
            raise RecordingError(f"{path}:1: has the column `{name}` twice")


def _is_whole(path: str) -> bool:
    """Whether a table has the end of its run: by its name, as nothing in it says so, and because its last line has an
    end; otherwise the process was killed while it wrote that line.
    """
    if is_part_name(path):
        return False
    with open(path, "rb") as file:
        size = file.seek(0, os.SEEK_END)
        file.seek(max(size - 1, 0))
        return file.read() == b"\n"


def _require_all_parameters(
    path: str, columns: Sequence[str], ports: Sequence[RecordedPort], known: Sequence[RecordedPort]
) -> None:
    for port in ports:
        found = [name for name in columns if port.direction == "parameter" and name.startswith(f"{port.name}.")]
        if found and port not in known:
            wanted = ", ".join(name for name, _, _ in leaves(port.name, port.type))
            raise RecordingError(f"{path} has the columns {', '.join(found)}, and the program the parameters {wanted}")


def _guessed(file: Any, columns: Sequence[str]) -> dict[str, Type]:
    kinds: dict[str, Type] = {}
    names: dict[str, dict[str, None]] = {}
    for row in csv.reader((line for line in file if line.endswith("\n")), skipinitialspace=True):
        for name, cell in zip(columns, row, strict=False):
            if not cell or isinstance(kinds.get(name), RealType | EnumType):
                if cell and name in names:
                    names[name].setdefault(cell)
                continue
            if cell in ("true", "false"):
                kinds[name] = BOOL
            elif cell.lstrip("-").isdigit():
                kinds.setdefault(name, INT)
            else:
                try:
                    float(cell)
                    kinds[name] = DOUBLE
                except ValueError:
                    names.setdefault(name, {}).setdefault(cell)
                    kinds[name] = EnumType(name, ())
    return {name: EnumType(name, tuple(names[name])) if name in names else kinds.get(name, DOUBLE) for name in columns}


@record
class _Row:
    """A row that is whole; ``line`` is its number in the file, ``time`` in nanoseconds."""

    line: int
    time: int
    cells: list[str]


class _Table:
    """Rows of a table that are values: a cell that differs from the one above it is a new one; of a sampled port every
    tick has one.
    """

    def __init__(self, path: str, columns: Sequence[str], head: RecordingHead) -> None:
        self._path = path
        self._columns = list(columns)
        self._head = head

    def rows(self) -> Iterator[list[_Row]]:
        """The rows, part by part. A last row that was cut is left out."""
        part: list[_Row] = []
        width = len(self._columns)
        before = 0
        with open(self._path, newline="", encoding=_ENCODING) as file:
            next(file)
            for number, line in enumerate(file, 2):
                if not line.endswith("\n"):
                    break  # The process was killed while it was written.
                cells = next(csv.reader([line], skipinitialspace=True), [])
                try:
                    if len(cells) != width:
                        raise ValueError(f"{counted(len(cells), 'cell')} for {counted(width, 'column')}")
                    time = round(float(cells[0]) * 1e9)
                    if not 0 <= time <= IntType().maximum:
                        raise ValueError(f"{cells[0]} s is no time of a run")
                    if time < before:
                        raise ValueError(f"its time, {cells[0]} s, is before that of the row above it")
                    before = time
                    part.append(_Row(number, time, cells))
                except (ValueError, OverflowError) as problem:
                    raise RecordingError(f"{self._path}:{number}: is no row of a recording: {problem}") from None
                if len(part) == _ROWS:
                    yield part
                    part = []
        if part:
            yield part

    def read(self, positions: Sequence[int]) -> Iterator[Sequence[Block]]:
        """See ``StoredRecording.read``."""
        last: dict[int, list[str]] = {}
        for part in self.rows():
            found = []
            for position in positions:
                block = self._block(position, part, last)
                if len(block.time):
                    found.append(block)
            yield found

    def _block(self, position: int, part: Sequence[_Row], last: dict[int, list[str]]) -> Block:
        import numpy

        port = self._head.ports[position]
        own = [(self._columns.index(name), kind) for name, kind, _ in leaves(port.name, port.type)]
        kept = []
        before = last.get(position)
        for row in part:
            present = [row.cells[column] for column, _ in own]
            is_tick = port.period > 0 and (row.time - port.offset) % port.period == 0
            if all(present) and (present != before or (is_tick and port.direction == "in")):
                kept.append(row)
            before = present
        if before is not None:
            last[position] = before
        values = assembled([self._numbers(column, kind, kept) for column, kind in own], port.type, len(kept))
        return Block(position, numpy.array([row.time for row in kept], numpy.int64), values)

    def _numbers(self, column: int, kind: Type, rows: Sequence[_Row]) -> numpy.ndarray:
        """The cells of a column as values. Raises RecordingError for the first that is none."""
        import numpy

        numbers = []
        for row in rows:
            try:
                numbers.append(_number(row.cells[column], kind))
            except ValueError as problem:
                raise self._no_value(column, row, problem) from None
        try:
            return as_values(numpy.array(numbers), kind)
        except NoValueError as problem:
            raise self._no_value(column, rows[problem.position], problem) from None

    def _no_value(self, column: int, row: _Row, problem: ValueError) -> RecordingError:
        return RecordingError(f"{self._path}:{row.line}: column `{self._columns[column]}`: {problem}")


def _number(cell: str, kind: Type) -> Any:
    match kind:
        case BoolType():
            if cell not in ("true", "false"):
                raise ValueError(f"{cell!r} is neither true nor false")
            return cell == "true"
        case EnumType(literals=literals):
            if cell not in literals:
                raise ValueError(f"{cell!r} is none of {', '.join(literals)}")
            return literals.index(cell)
        case RealType():
            return _read(float, cell, "number")
        case IntType() | TimeType():
            return _read(int, cell, "whole number")
        case StructType() | ArrayType() | TextType() | UnknownType():
            raise ValueError(f"{kind} is not one number")


def _read(number: Callable[[str], float], cell: str, what: str) -> float:
    try:
        return number(cell)
    except ValueError:
        raise ValueError(f"{cell[:60]!r} is not a {what}") from None


def open_parquet(path: str) -> StoredRecording:
    """The recording in a Parquet file. Raises RecordingError, MissingPackageError, and OSError."""
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        raise missing_package("pyarrow", "parquet") from None
    try:
        with parquet.ParquetFile(path) as file:
            about = json.loads((file.schema_arrow.metadata or {})[b"cspdiag"])
            columns = file.schema_arrow.names
        head = head_from(about["cspdiag"])
    except pyarrow.ArrowException as problem:
        raise RecordingError(f"{path} is no Parquet file, or was cut: {problem}") from None
    except (KeyError, ValueError, TypeError):
        raise RecordingError(f"{path} is not a recording of cspdiag: it does not say what its signals are") from None

    wanted = ["time", *(name for port in head.ports for name, _, _ in leaves(port.name, port.type))]
    missing = [name for name in wanted if name not in columns]
    if missing:
        word = "column" if len(missing) == 1 else "columns"
        raise RecordingError(f"{path} has no {word} {', '.join(missing)}; it has: {', '.join(columns)}")

    def read(positions: Sequence[int]) -> Iterator[Sequence[Block]]:
        with parquet.ParquetFile(path, page_checksum_verification=True) as file:
            for batch in file.iter_batches(_ROWS):
                found = [_of_batch(batch, position, head.ports[position]) for position in positions]
                yield [block for block in found if len(block.time)]

    return StoredRecording(path, "Parquet", head, read, True, about["ended"], about["time"])


def _of_batch(batch: Any, position: int, port: RecordedPort) -> Block:
    import numpy

    time = batch.column("time").to_numpy()
    own = [(batch.column(name), kind) for name, kind, _ in leaves(port.name, port.type)]
    there: numpy.ndarray = numpy.ones(len(time), bool)
    for array, _ in own:
        there &= array.is_valid().to_numpy(zero_copy_only=False)
    numbers = []
    for array, kind in own:
        chosen = array.drop_null()
        if isinstance(kind, EnumType):
            numbers.append([kind.literals.index(name) for name in chosen.to_pylist()])
        else:
            numbers.append(chosen.to_numpy(zero_copy_only=False))
    return Block(position, time[there], assembled(numbers, port.type, int(there.sum())))
