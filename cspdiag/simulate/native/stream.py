"""Reads the reports of a native program on its run: the records of ``csp_stream.h``."""

from __future__ import annotations

import struct
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from io import BufferedIOBase
from typing import TYPE_CHECKING

from cspdiag.base.record import record
from cspdiag.model.types import Type
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.simulate.deadlock.waiting import WaitingRecord, broadcast_readers
from cspdiag.simulate.native.recorded_rows import RecordedRows
from cspdiag.simulate.native.rows import ROW, SIZE, Kind, PassedRows, channel_of, kinds_of
from cspdiag.simulate.native.tuning import Refusals
from cspdiag.simulate.record.recorder import Recorder

if TYPE_CHECKING:
    import numpy

    from cspdiag.runtime.kernel.parameters import Change

CHUNK = 1 << 20
"""The most bytes that are read at a time."""

_PAYLOAD = 8
"""Where the bytes of a text begin in a row."""
_NO_END = 2**32 - 1
_NEVER = 2**63 - 1
_DURATION = struct.Struct("=d")
_HAVE_VALUES = (Kind.COMMUNICATION, Kind.RELEASE, Kind.SAMPLE)
_TEXTS = {Kind.CHANNEL: 1, Kind.PROCESS: 2, Kind.WAITING: 4, Kind.END_OF_RUN: 3}
"""How many texts follow."""


@dataclass
class EndRecord:
    """The end of a run: the number of a ``csp_ending``, the time in nanoseconds, and its duration in seconds."""

    ending: int
    time: int
    duration: float
    exception: str
    message: str
    place: str


@record
class HeldRecord:
    """A steered run waits for an order: whether it has reached the instant of the last order, the next instant at
    which something may happen, None if there is none, and, if that was asked, which processes wait.
    """

    reached: bool
    next: int | None
    waiting: tuple[WaitingRecord, ...] = ()


@dataclass
class StreamReader:
    """Tells a recorder about the processes of one run of a network, and keeps the values that are passed."""

    stream: BufferedIOBase
    network: CoreNetwork
    recorder: Recorder
    passed: PassedRows | RecordedRows | None = None
    """Where values are kept; None if none are reported."""
    changes: Sequence[Change] = ()
    """The changes of parameters that the program is given, by their numbers."""
    flattened: bool = False
    """Whether processes are inlined in the thread that runs them, as with ``-O1``."""
    now: int = 0
    end: EndRecord | None = None
    held: HeldRecord | None = None
    """Where a steered run waits for an order; its reader forgets it before the next."""
    missed: dict[str, int] = field(default_factory=dict)
    waiting: list[WaitingRecord] = field(default_factory=list)
    _channels: dict[int, str] = field(default_factory=dict)
    _processes: dict[int, tuple[str, str]] = field(default_factory=dict)
    _rest: bytes = b""
    """Of a record of which not everything has been read."""
    _head: tuple[int, ...] = ()
    """The fields of the record whose texts are being read."""
    _texts: list[str] = field(default_factory=list)
    _text: bytes = b""
    _length: int | None = None
    """The length of the text that is being read; None if there is none."""

    def __post_init__(self) -> None:
        self._types: Mapping[str, Type] = {net.path: net.type for net in self.network.nets}
        self._refusals = Refusals(self.network)

    def read(self) -> None:
        """Read all records, to the end of the stream. Raises EOFError if it ends in the middle of one."""
        while self.read_some():
            pass

    def read_some(self) -> bool:
        """Read what is available, at least one byte; False at the end of the stream. Raises EOFError, too."""
        more = self.stream.read1(CHUNK)
        if more:
            data = self._rest + more if self._rest else more
            self._rest = data[self._take(data) :]
        elif self._rest or self._head:
            raise EOFError("the program ended in the middle of a record")
        return bool(more)

    def _take(self, data: bytes) -> int:
        """Take the records that are whole; returns how many bytes they have."""
        rows = len(data) // SIZE
        if self.passed is None:
            for position in range(0, rows * SIZE, SIZE):
                self._take_row(data, position)
            return rows * SIZE
        return self._take_values(data, rows, self.passed) * SIZE

    def _take_values(self, data: bytes, rows: int, passed: PassedRows | RecordedRows) -> int:
        """Take whole records, most of which have values; returns how many rows they have."""
        import numpy

        kinds = kinds_of(data[: rows * SIZE])
        for row in numpy.flatnonzero(_without_values(kinds)).tolist():
            if kinds[row] == Kind.RELEASE and self._is_cut(data, row, rows):
                rows = row
                break
            self._take_row(data, row * SIZE)
        last = rows - 1
        while last > 0 and kinds[last] == Kind.CONTINUATION:
            last -= 1
        if rows and kinds[last] in _HAVE_VALUES:
            if self._is_cut(data, last, rows):
                rows = last
            else:
                self.now = ROW.unpack_from(data, last * SIZE)[2]
        passed.add(data[: rows * SIZE])
        return rows

    def _is_cut(self, data: bytes, row: int, rows: int) -> bool:
        """Whether not all of the value in this row has arrived."""
        assert self.passed is not None
        _, number, *_ = ROW.unpack_from(data, row * SIZE)
        return row + self.passed.channels[number].continuations >= rows

    def _take_row(self, data: bytes, position: int) -> None:
        """Take a row of a record without a value, or with a safe value, all of which has arrived."""
        fields = ROW.unpack_from(data, position)
        kind = fields[0]
        if kind in (Kind.TEXT, Kind.CONTINUATION):
            self._take_text(kind, fields[1], data[position + _PAYLOAD : position + SIZE])
        elif kind in _TEXTS:
            self._head, self._texts = fields, []
        elif kind == Kind.RELEASE:
            assert self.passed is not None
            channel = self.passed.channels[fields[1]]
            self.recorder.released(fields[2], channel.name, channel.value(data, position))
        else:
            self._take_event(*fields)

    def _take_text(self, kind: int, length: int, part: bytes) -> None:
        if kind == Kind.TEXT:
            self._text, self._length = part, length
        elif self._length is not None:
            self._text += part
        if self._length is None or len(self._text) < self._length:
            return
        self._texts.append(self._text[: self._length].decode("utf-8", "surrogateescape"))
        self._length = None
        if len(self._texts) == _TEXTS[self._head[0]]:
            self._take_named(*self._head)
            self._head = ()

    def _take_named(self, kind: int, number: int, time: int, size: int, _reader: int, value: int) -> None:
        """Take a record with texts."""
        match kind:
            case Kind.CHANNEL:
                self._take_channel(number, size, self._texts[0])
            case Kind.PROCESS:
                self._processes[number] = (self._texts[0], self._texts[1])
                if self.passed is not None:
                    self.passed.processes[number] = self._texts[0]
            case Kind.WAITING:
                _, _, place, words = self._texts
                # The path of the control law, if the process runs one.
                path, _, waits = words.removesuffix(f" ({place})").partition(" waits ")
                self.waiting.append(WaitingRecord(path, place, waits))
            case Kind.END_OF_RUN:
                self.now = time
                (duration,) = _DURATION.unpack(value.to_bytes(8, sys.byteorder))
                self.end = EndRecord(number, time, duration, *self._texts)
            case other:
                raise ValueError(f"records of kind {other} have no texts")

    def _take_channel(self, number: int, size: int, name: str) -> None:
        type_ = self._types.get(name)
        if type_ is None:
            return  # No process writes or reads this channel, so no record will name it.
        channel = channel_of(name, type_)
        if channel.size != size:
            raise ValueError(f"{name} has values of {size} bytes, and {type_} has {channel.size}")
        self._channels[number] = name
        if self.passed is not None:
            self.passed.channels[number] = channel

    def _take_event(self, kind: int, number: int, time: int, first: int, second: int, value: int) -> None:
        match kind:
            case Kind.BEGIN:
                self.now = time
                self.recorder.process_started(time, *self._processes[number])
            case Kind.END:
                self.now = time
                self.recorder.process_ended(time, self._processes[number][0])
            case Kind.MISSED:
                self.missed[self._channels[number]] = first
            case Kind.EXECUTION_TIME:
                path, _ = self._processes.get(number, ("", ""))
                if path:
                    self.recorder.execution_time(path, time, value, "thread" if self.flattened else "process")
            case Kind.PRESENT:
                self.now = time
                if first:
                    self.held = HeldRecord(bool(second), value if value < _NEVER else None, tuple(self.waiting))
                    self.waiting.clear()
            case Kind.CHANGED if value:
                change = self.changes[number]
                self._refusals.made(change)
                self.recorder.changed(time, change.parameter, change.path, change.value)
            case Kind.CHANGED:
                change = self.changes[number]
                reason = self._refusals.reason(change)
                self.recorder.refused.append((change.time, change.parameter, reason))
            case Kind.WAITING_AT:
                self._take_place(number, first)
            case other:
                raise ValueError(f"there are no records of kind {other}")

    def _take_place(self, number: int, end: int) -> None:
        """Note a channel at which the last process waits, or an end that its broadcast misses."""
        if number not in self._channels:
            return
        record, channel = self.waiting[-1], self._channels[number]
        if end == _NO_END:
            record.channels += (channel,)
        else:
            record.missing += (self._broadcast_readers[channel][end],)

    @cached_property
    def _broadcast_readers(self) -> dict[str, list[str]]:
        return broadcast_readers(self.network)


def _without_values(kinds: numpy.ndarray) -> numpy.ndarray:
    """Which rows are not part of records whose values are only kept."""
    import numpy

    records = kinds
    if not kinds.all():  # Some rows continue others.
        heads = numpy.where(kinds != Kind.CONTINUATION, numpy.arange(len(kinds)), 0)
        records = kinds[numpy.maximum.accumulate(heads)]
    without: numpy.ndarray = (records != Kind.COMMUNICATION) & (records != Kind.SAMPLE)
    return without
