"""The values that a native program reports, kept as they come: rows of 32 bytes, as in ``csp_stream.h``.

They become arrays or objects only when they are read.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from cspdiag.base.record import record
from cspdiag.model.types import Type
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.simulate.native.parties import Parties
from cspdiag.simulate.native.values import Decoder, decoder, layout, numpy_type, require_enumerators
from cspdiag.simulate.record.history import History
from cspdiag.simulate.record.leaves import column

if TYPE_CHECKING:
    import numpy

ROW = struct.Struct("=IIqIIQ")
"""Kind, number, time, writer, reader, value."""
SIZE = ROW.size
_SORTED_AT_ONCE = 1 << 20
"""Bytes, which with what is made of them fit into the caches of a processor."""
_BITS_OF_KIND = 4
"""Of the number by which rows are sorted: no kind has more."""
_VALUE = slice(24, 32)
_PAYLOAD = slice(8, 32)


class Kind:
    """The kinds of rows, as plain numbers, with which numpy compares faster than with members of an enum."""

    CONTINUATION = 0
    CHANNEL = 1
    PROCESS = 2
    COMMUNICATION = 3
    BEGIN = 4
    END = 5
    RELEASE = 6
    TEXT = 7
    WAITING = 8
    MISSED = 9
    END_OF_RUN = 10
    EXECUTION_TIME = 11
    SAMPLE = 12
    WAITING_AT = 13
    PRESENT = 14
    CHANGED = 15


@record
class Channel:
    """A channel of a native program; its values have ``size`` bytes."""

    name: str
    type: Type
    size: int
    decode: Decoder

    @property
    def continuations(self) -> int:
        """How many rows continue a record with a value."""
        return -(-max(self.size - 8, 0) // 24)

    def value(self, data: bytes, position: int) -> object:
        """The value of the record at this position."""
        found = data[position + _VALUE.start : position + SIZE]
        for row in range(position + SIZE, position + SIZE * (1 + self.continuations), SIZE):
            found += data[row + _PAYLOAD.start : row + SIZE]
        return self.decode(found[: self.size])


def channel_of(name: str, type_: Type) -> Channel:
    """A channel with values as this machine's C compilers lay them out."""
    return Channel(name, type_, layout(type_)[0], decoder(type_))


def kinds_of(data: bytes) -> numpy.ndarray:
    """The kind of each row."""
    import numpy

    return numpy.frombuffer(data, numpy.uint32)[:: SIZE // 4].astype(numpy.uint8)


class PassedRows:
    """What a native program has passed; see ``Passed``.

    ``channels`` and ``processes`` are those that the program has named, by number. ``keeps_order`` says whether the
    communications can be asked for; otherwise only the history of each channel is kept, which takes half the memory.
    """

    def __init__(self, network: CoreNetwork, *, keeps_order: bool) -> None:
        self.channels: dict[int, Channel] = {}
        self.processes: dict[int, str] = {0: ""}
        self._network = network
        self._keeps_order = keeps_order
        self._rows: list[bytes] = []
        """Records in order, of which none is in two parts."""
        self._unsorted = 0
        """The position in ``_rows`` of the first that are not in the series, and how many bytes those have."""
        self._size = 0
        self._series: dict[int, _Series] = {}

    def add(self, data: bytes) -> None:
        """Keep whole records."""
        self._rows.append(data)
        self._size += len(data)
        if self._size >= _SORTED_AT_ONCE and not self._keeps_order:
            self._sort_rows()

    @property
    def size(self) -> int:
        """How many bytes the records have that are kept in their order."""
        return sum(map(len, self.parts))

    @property
    def parts(self) -> Sequence[bytes]:
        """The records that are kept in their order."""
        return self._rows if self._keeps_order else ()

    @property
    def communications(self) -> Iterator[tuple[int, str, object, str, str]]:
        """All communications in order, each as the fields of ``Communication``."""
        running: dict[str, None] = {}
        parties = Parties(self._network, running)
        for data in self.parts:
            yield from self.decoded(data, range(0, len(data), SIZE), parties, running)

    def decoded(
        self, data: bytes, positions: Iterable[int], parties: Parties, running: dict[str, None]
    ) -> Iterator[tuple[int, str, object, str, str]]:
        """The communications at these positions; what begins and ends there is noted in ``running``."""
        for position in positions:
            kind, number, time, writer, reader, _ = ROW.unpack_from(data, position)
            if kind == Kind.COMMUNICATION:
                channel = self.channels[number]
                source = parties.writer(channel.name, self.processes[writer])
                sink = parties.reader(channel.name, self.processes[reader])
                yield time, channel.name, channel.value(data, position), source, sink
            elif kind == Kind.BEGIN:
                running[self.processes[number]] = None
            elif kind == Kind.END:
                running.pop(self.processes[number], None)

    @property
    def samples(self) -> Iterator[tuple[int, str, object]]:
        """All samples in order: time in nanoseconds, port, value."""
        for data in self.parts:
            for position in range(0, len(data), SIZE):
                kind, number, time, *_ = ROW.unpack_from(data, position)
                if kind == Kind.SAMPLE:
                    channel = self.channels[number]
                    yield time, channel.name, channel.value(data, position)

    def histories(self, types: Mapping[str, Type]) -> Mapping[str, History]:
        """See ``Passed.histories``."""
        self._sort_rows()
        return {self.channels[number].name: own.history() for number, own in self._series.items()}

    def take_histories(self) -> Mapping[str, History]:
        """The histories of what was added since the last call, which is not kept any longer."""
        self._sort_rows()
        found = {self.channels[number].name: own.history() for number, own in self._series.items()}
        self._series.clear()
        return found

    def _sort_rows(self) -> None:
        """Add the rows that are kept to the series, many at a time."""
        begin, size = self._unsorted, 0
        for position, data in enumerate(self._rows[begin:], begin + 1):
            size += len(data)
            if size >= _SORTED_AT_ONCE or position == len(self._rows):
                self._sort(b"".join(self._rows[begin:position]))
                begin, size = position, 0
        if not self._keeps_order:
            self._rows.clear()
        self._unsorted, self._size = len(self._rows), 0

    def _sort(self, data: bytes) -> None:
        """Add records to the series of their channels."""
        import numpy

        heads = numpy.frombuffer(data, numpy.uint32).reshape(-1, SIZE // 4)
        # One number for each channel and kind, small ones because these are sorted faster; sorting keeps the order in
        # time.
        small = numpy.uint16 if max(self.channels, default=0) < 1 << 16 - _BITS_OF_KIND else numpy.uint32
        keys = ((heads[:, 1] << _BITS_OF_KIND) | heads[:, 0]).astype(small)
        order = numpy.argsort(keys, kind="stable")
        keys = keys[order]
        groups = numpy.split(order, numpy.flatnonzero(keys[1:] != keys[:-1]) + 1) if len(keys) else []
        for group in sorted(groups, key=lambda group: int(group[0])):
            kind, number = heads[group[0], :2].tolist()
            if kind not in (Kind.COMMUNICATION, Kind.SAMPLE):
                continue
            if number not in self._series:
                self._series[number] = _Series(self.channels[number])
            self._series[number].add(data, group, is_sample=kind == Kind.SAMPLE)


class _Series:
    """The values of one channel as they are in memory, and their instants."""

    def __init__(self, channel: Channel) -> None:
        self._channel = channel
        self._passed: list[tuple[numpy.ndarray, numpy.ndarray]] = []
        self._samples: list[tuple[numpy.ndarray, numpy.ndarray]] = []

    def add(self, data: bytes, positions: numpy.ndarray, *, is_sample: bool) -> None:
        """Add the records at these rows."""
        import numpy

        words = numpy.frombuffer(data, numpy.int64).reshape(-1, SIZE // 8)
        values = words[positions, 3]
        if self._channel.size != values.itemsize:
            parts = [values.view(numpy.uint8).reshape(-1, 8)]
            payloads = numpy.frombuffer(data, numpy.uint8).reshape(-1, SIZE)[:, _PAYLOAD]
            parts += [payloads[positions + row] for row in range(1, self._channel.continuations + 1)]
            values = numpy.ascontiguousarray(numpy.concatenate(parts, axis=1)[:, : self._channel.size]).reshape(-1)
        added = words[positions, 1], numpy.frombuffer(values, numpy_type(self._channel.type))
        (self._samples if is_sample else self._passed).append(added)

    def history(self) -> History:
        """The history of the channel: of a sampled input its samples, of any other what was passed. Raises
        NoEnumeratorError.
        """
        import numpy

        is_sampled = bool(self._samples)
        times, raw = _joined(self._samples if is_sampled else self._passed)
        require_enumerators(self._channel.type, raw)
        wanted = column([], self._channel.type).dtype
        found = raw if raw.dtype == wanted and wanted.names is None else raw.astype(wanted)
        read = _joined(self._passed)[0] if is_sampled and self._passed else numpy.empty(0, numpy.int64)
        return History(times, found, read, is_sampled)


def _joined(parts: list[tuple[numpy.ndarray, numpy.ndarray]]) -> tuple[numpy.ndarray, numpy.ndarray]:
    """The instants and the values of one series, which has some."""
    import numpy

    if len(parts) > 1:
        times, values = zip(*parts, strict=True)
        parts[:] = [(numpy.concatenate(times), numpy.concatenate(values))]
    return parts[0]
