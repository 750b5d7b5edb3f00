"""Reads the reports of a native program on its run: the records of ``csp_stream.h``."""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from io import BufferedIOBase

from cspdiag.model.types import Type
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.simulate.native.parties import Parties
from cspdiag.simulate.native.values import Decoder, decoder, layout
from cspdiag.simulate.record.recorder import Recorder

_CHUNK = 1 << 16

_CHANNEL = struct.Struct("=IH")
_NUMBER = struct.Struct("=I")
_LENGTH = struct.Struct("=H")
_COMMUNICATION = struct.Struct("=qIII")
_EVENT = struct.Struct("=qI")
_PAIR = struct.Struct("=II")
_END = struct.Struct("=Bqd")
_EXECUTION = struct.Struct("=Iqq")


@dataclass
class WaitingRecord:
    """A process that waits when nothing can continue.

    ``missing`` are the ends of a broadcast that have not taken the value which the process writes, for each of
    ``channels``, counted from 0 in the order of the network's readers.
    """

    path: str
    source: str
    place: str
    words: str
    channels: tuple[str, ...]
    missing: tuple[tuple[int, ...], ...]


@dataclass
class EndRecord:
    """The end of a run: the number of a ``csp_ending``, the time in nanoseconds, and its duration in seconds."""

    ending: int
    time: int
    duration: float
    exception: str
    message: str
    place: str


@dataclass
class StreamReader:
    """Passes the records of one run of a network to a recorder."""

    stream: BufferedIOBase
    network: CoreNetwork
    recorder: Recorder
    flattened: bool = False
    """Whether processes are inlined in the thread that runs them, as with ``-O1``."""
    now: int = 0
    end: EndRecord | None = None
    missed: dict[str, int] = field(default_factory=dict)
    waiting: list[WaitingRecord] = field(default_factory=list)
    _data: bytes = b""
    _position: int = 0
    _channels: dict[int, tuple[str, int, Decoder]] = field(default_factory=dict)
    _processes: dict[int, tuple[str, str]] = field(default_factory=lambda: {0: ("", "")})

    def __post_init__(self) -> None:
        self._types: Mapping[str, Type] = {net.path: net.type for net in self.network.nets}
        self._parties = Parties(self.network, self.recorder.running.keys())

    def read(self) -> None:
        """Read all records, to the end of the stream."""
        handlers: dict[int, Callable[[], None]] = {
            1: self._channel, 2: self._process, 3: self._communication, 4: self._begin, 5: self._end_of,
            6: self._release,
            8: self._waiting, 9: self._missed, 10: self._ended,
            11: self._execution_time, 12: self._sample,
        }  # fmt: skip
        while self._has(1):
            kind = self._data[self._position]
            self._position += 1
            handlers[kind]()

    def _has(self, size: int) -> bool:
        """Whether this number of bytes follows; they are then in memory."""
        while len(self._data) - self._position < size:
            more = self.stream.read1(_CHUNK)  # Whatever is available, without waiting for more.
            if not more:
                return False
            self._data = self._data[self._position :] + more
            self._position = 0
        return True

    def _bytes(self, size: int) -> bytes:
        if not self._has(size):
            raise EOFError("the program ended in the middle of a record")
        self._position += size
        return self._data[self._position - size : self._position]

    def _text(self) -> str:
        (length,) = _LENGTH.unpack(self._bytes(2))
        return self._bytes(length).decode("utf-8", "surrogateescape")

    def _channel(self) -> None:
        number, size = _CHANNEL.unpack(self._bytes(6))
        name = self._text()
        type_ = self._types.get(name)
        if type_ is None:
            return  # No process writes or reads this channel, so no record will name it.
        if layout(type_)[0] != size:
            raise ValueError(f"{name} has values of {size} bytes, and {type_} has {layout(type_)[0]}")
        self._channels[number] = (name, size, decoder(type_))

    def _process(self) -> None:
        (number,) = _NUMBER.unpack(self._bytes(4))
        self._processes[number] = (self._text(), self._text())

    def _communication(self) -> None:
        time, channel, writer, reader = _COMMUNICATION.unpack(self._bytes(20))
        name, size, decode = self._channels[channel]
        value = decode(self._bytes(size))
        self.now = time
        source = self._parties.writer(name, self._processes[writer][0])
        sink = self._parties.reader(name, self._processes[reader][0])
        self.recorder.communication(time, name, value, source, sink)

    def _begin(self) -> None:
        self.now, number = _EVENT.unpack(self._bytes(12))
        path, kind = self._processes[number]
        self.recorder.process_started(self.now, path, kind)

    def _end_of(self) -> None:
        self.now, number = _EVENT.unpack(self._bytes(12))
        self.recorder.process_ended(self.now, self._processes[number][0])

    def _release(self) -> None:
        time, channel = _EVENT.unpack(self._bytes(12))
        name, size, decode = self._channels[channel]
        self.recorder.released(time, name, decode(self._bytes(size)))

    def _sample(self) -> None:
        time, channel = _EVENT.unpack(self._bytes(12))
        name, size, decode = self._channels[channel]
        self.recorder.sampled(time, name, decode(self._bytes(size)))

    def _waiting(self) -> None:
        self._bytes(4)
        _, source, place, words = self._text(), self._text(), self._text(), self._text()
        path = words.partition(" waits ")[0]  # The place in the law, if a process runs one.
        (count,) = _LENGTH.unpack(self._bytes(2))
        entries = [(_NUMBER.unpack(self._bytes(4))[0], self._missing_ends()) for _ in range(count)]
        known = [(self._channels[number][0], missing) for number, missing in entries if number in self._channels]
        names, missing = tuple(name for name, _ in known), tuple(ends for _, ends in known)
        self.waiting.append(WaitingRecord(path, source, place, words, names, missing))

    def _missing_ends(self) -> tuple[int, ...]:
        (count,) = _LENGTH.unpack(self._bytes(2))
        return tuple(_LENGTH.unpack(self._bytes(2))[0] for _ in range(count))

    def _missed(self) -> None:
        channel, count = _PAIR.unpack(self._bytes(8))
        self.missed[self._channels[channel][0]] = count

    def _execution_time(self) -> None:
        number, longest, steps = _EXECUTION.unpack(self._bytes(20))
        path = self._processes[number][0]
        if path:
            self.recorder.execution_time(path, longest, steps, "thread" if self.flattened else "process")

    def _ended(self) -> None:
        ending, time, duration = _END.unpack(self._bytes(17))
        self.now = time
        self.end = EndRecord(ending, time, duration, self._text(), self._text(), self._text())
