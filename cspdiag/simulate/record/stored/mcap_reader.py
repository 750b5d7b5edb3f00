"""MCAP files that cspdiag has written, up to the last whole chunk if the file is cut."""

from __future__ import annotations

import json
import os
import struct
import zlib
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, BinaryIO

from cspdiag.base.record import record
from cspdiag.simulate.record.stored.described import RecordedPort, RecordingHead, head_from
from cspdiag.simulate.record.stored.recording import RecordingError, StoredRecording, assembled
from cspdiag.simulate.record.streamed.blocks import Block
from cspdiag.simulate.record.streamed.mcap.mcap_file import END, METADATA
from cspdiag.simulate.record.streamed.mcap.mcap_records import MAGIC, Opcode
from cspdiag.simulate.record.streamed.mcap.messages import Message, decoded, message_of

if TYPE_CHECKING:
    import numpy

_HEAD = 31
"""The bytes of a message before its data."""


@record
class _Record:
    """A record: where its content is in the file."""

    opcode: int
    start: int
    size: int


def open_mcap(path: str) -> StoredRecording:
    """The recording in an MCAP file. Raises RecordingError, and OSError."""
    with open(path, "rb") as file:
        if file.read(len(MAGIC)) != MAGIC:
            raise RecordingError(f"{path} is no MCAP file")
        head: RecordingHead | None = None
        ended, time, last, encoding = "", 0, 0, "cdr"
        for found in _records(file, os.path.getsize(path)):
            if found.opcode == Opcode.METADATA:
                name, values = _metadata(_content(file, found))
                if name == METADATA:
                    head = _head(path, values)
                elif name == END:
                    ended, time = values.get("ended", ""), int(values.get("time", "0"))
            elif found.opcode == Opcode.CHANNEL:
                encoding = _channel_encoding(_content(file, found))
            elif found.opcode == Opcode.CHUNK:
                file.seek(found.start)
                last = max(last, struct.unpack("<QQ", file.read(16))[1])
    if head is None:
        raise RecordingError(f"{path} is not a recording of cspdiag: it does not say what its signals are")
    messages = tuple(None if encoding == "json" else message_of(port.type) for port in head.ports)
    reader = _Reader(path, head.ports, messages)
    what = "MCAP, messages as JSON" if encoding == "json" else "MCAP, messages of ROS 2"
    return StoredRecording(path, what, head, reader.blocks, bool(ended), ended, time if ended else last)


def _head(path: str, values: Mapping[str, str]) -> RecordingHead:
    try:
        return head_from(json.loads(values["head"]))
    except (ValueError, KeyError, TypeError) as problem:
        raise RecordingError(f"{path} is damaged: what it says of its signals cannot be read") from problem


def _records(file: BinaryIO, size: int) -> Iterator[_Record]:
    """The whole records of the data section, in order."""
    position = len(MAGIC)
    while position + 9 <= size:
        file.seek(position)
        opcode, length = struct.unpack("<BQ", file.read(9))
        if position + 9 + length > size or opcode in (0, Opcode.DATA_END, Opcode.FOOTER):
            return
        yield _Record(opcode, position + 9, length)
        position += 9 + length


def _content(file: BinaryIO, found: _Record) -> bytes:
    file.seek(found.start)
    return file.read(found.size)


def _text(data: bytes, position: int) -> tuple[str, int]:
    (length,) = struct.unpack_from("<I", data, position)
    end = position + 4 + length
    return data[position + 4 : end].decode("utf-8", "replace"), end


def _metadata(data: bytes) -> tuple[str, dict[str, str]]:
    name, position = _text(data, 0)
    position += 4
    values = {}
    while position < len(data):
        key, position = _text(data, position)
        values[key], position = _text(data, position)
    return name, values


def _channel_encoding(data: bytes) -> str:
    _, position = _text(data, 4)
    return _text(data, position)[0]


@record
class _Reader:
    path: str
    ports: tuple[RecordedPort, ...]
    messages: tuple[Message | None, ...]

    def blocks(self, positions: Sequence[int]) -> Iterator[Sequence[Block]]:
        """The values of these ports, chunk by chunk; a chunk that is damaged raises RecordingError."""
        with open(self.path, "rb") as file:
            for found in _records(file, os.path.getsize(self.path)):
                if found.opcode != Opcode.CHUNK:
                    continue
                yield self._decoded(self._data(_content(file, found)), positions)

    def _data(self, content: bytes) -> bytes:
        _, _, size, checksum = struct.unpack_from("<QQQI", content)
        compression, position = _text(content, 28)
        data = content[position + 8 :]
        if compression:
            data = _decompressed(self.path, compression, data, size)
        if checksum and zlib.crc32(data) != checksum:
            raise RecordingError(f"{self.path} is damaged: a chunk does not fit its checksum")
        return data

    def _decoded(self, data: bytes, positions: Sequence[int]) -> list[Block]:
        import numpy

        places = _places(data)
        whole = numpy.frombuffer(data, numpy.uint8)
        found = []
        for position in positions:
            own = places.get(position + 1)
            if own is None:
                continue
            starts = numpy.array(own, numpy.int64)
            heads = whole[starts[:, None] + numpy.arange(15, 23)]
            time = heads.view("<i8").reshape(-1)
            found.append(Block(position, time, self._values(position, data, whole, starts)))
        return found

    def _values(self, position: int, data: bytes, whole: numpy.ndarray, starts: numpy.ndarray) -> numpy.ndarray:
        import numpy

        from cspdiag.simulate.record.stored.json_values import values_from

        message, kind = self.messages[position], self.ports[position].type
        if message is None:
            ends = [place + 9 + struct.unpack_from("<Q", data, place + 1)[0] for place in starts.tolist()]
            texts = [data[place + _HEAD : end] for place, end in zip(starts.tolist(), ends, strict=True)]
            return values_from(texts, kind)
        rows = whole[starts[:, None] + numpy.arange(_HEAD, _HEAD + message.size)]
        return assembled(decoded(message, rows), kind, len(starts))


def _places(data: bytes) -> dict[int, list[int]]:
    """Where the messages of each channel begin in a chunk."""
    found: dict[int, list[int]] = {}
    position, size = 0, len(data)
    unpack = struct.Struct("<BQH").unpack_from
    while position < size:
        opcode, length, channel = unpack(data, position)
        if opcode == Opcode.MESSAGE:
            own = found.get(channel)
            if own is None:
                own = found[channel] = []
            own.append(position)
        position += 9 + length
    return found


def _decompressed(path: str, compression: str, data: bytes, size: int) -> bytes:
    """The content of a chunk that another tool has compressed."""
    from importlib import import_module

    from cspdiag.base.errors import missing_package

    package = {"zstd": "zstandard", "lz4": "lz4.frame"}.get(compression)
    if package is None:
        raise RecordingError(f"{path}: unknown compression {compression!r}")
    try:
        module = import_module(package)
    except ImportError:
        raise missing_package(package.partition(".")[0], "mcap") from None
    if compression == "zstd":
        unpacked: bytes = module.ZstdDecompressor().decompress(data, max_output_size=size)
        return unpacked
    plain: bytes = module.decompress(data)
    return plain
