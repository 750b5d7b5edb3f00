"""MCAP files: a chunk for each block of time, after which the file is whole, though without its index, until the run
ends.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Literal

from cspdiag.base.record import record
from cspdiag.simulate.record.stored.described import RecordingHead, head_data
from cspdiag.simulate.record.streamed.blocks import Block
from cspdiag.simulate.record.streamed.mcap import mcap_records as mcap
from cspdiag.simulate.record.streamed.mcap.fixed_messages import FixedChunk, FixedMessages
from cspdiag.simulate.record.streamed.mcap.json_messages import JsonChunk, json_schema
from cspdiag.simulate.record.streamed.mcap.mcap_records import Opcode
from cspdiag.simulate.record.streamed.mcap.messages import Message, message_of, topics
from cspdiag.simulate.record.streamed.part_file import PartFile, Sink

if TYPE_CHECKING:
    import numpy

Encoding = Literal["ros2", "json"]
METADATA = "cspdiag"
END = "cspdiag.end"
"""The names of the metadata at the beginning and at the end."""
_HEAD_OF_INDEX = 15
"""The bytes of a message index before its entries."""
_INDEX_ENTRY = 16


@record
class _Chunk:
    """What the index says of a chunk: where it is, its size, where the index of each of its channels is, and the times
    and the numbers of its messages.
    """

    start: int
    size: int
    content: int
    first: int
    last: int
    indexes: Mapping[int, int]
    index_size: int
    counts: Mapping[int, int]


class McapFile:
    """See ``Writer``. The file is opened for writing, at its beginning; it needs no places if it is a pipe."""

    def __init__(self, file: Sink, head: RecordingHead, encoding: Encoding) -> None:
        import numpy

        self._file = file
        self._head = head
        self._encoding = encoding
        self._messages: list[Message | None] = [
            message_of(port.type) if encoding == "ros2" else None for port in head.ports
        ]
        self._chunks: list[_Chunk] = []
        self._counts = dict.fromkeys(range(len(head.ports)), 0)
        self._schemas: list[bytes] = []
        self._channels: list[bytes] = []
        self._fixed = [
            FixedMessages(position, message, port.type)
            for position, (port, message) in enumerate(zip(head.ports, self._messages, strict=True))
            if message is not None
        ]
        self._room: numpy.ndarray = numpy.empty(0, numpy.uint8)
        """Memory for a chunk."""
        self._describe()
        self._seeks = file.seekable()
        self._end = 0
        """Where the next record is written: over the end that the file has for now."""
        header = mcap.record(Opcode.HEADER, mcap.text("ros2" if encoding == "ros2" else "") + mcap.text("cspdiag"))
        self._metadata = mcap.metadata(METADATA, {"head": json.dumps(head_data(head))})
        self._metadata_start = len(mcap.MAGIC) + len(header)
        self._put(mcap.MAGIC + header + self._metadata + b"".join([*self._schemas, *self._channels]))

    @property
    def counts(self) -> Mapping[int, int]:
        """How many messages each channel has."""
        return self._counts

    @property
    def span(self) -> tuple[int, int]:
        """The first and the last instant of a message; 0 if there is none."""
        if not self._chunks:
            return 0, 0
        return self._chunks[0].first, self._chunks[-1].last

    def _describe(self) -> None:
        """Schemas and channels, numbered from 1; ports with messages of one type share a schema."""
        known: dict[tuple[str, str], int] = {}
        ports = self._head.ports
        for number, (port, message, topic) in enumerate(
            zip(ports, self._messages, topics([port.name for port in ports]), strict=True), 1
        ):
            name, text = (message.name, message.definition) if message else (str(port.type), json_schema(port.type))
            schema = known.setdefault((name, text), len(known) + 1)
            if schema > len(self._schemas):
                self._schemas.append(mcap.schema(schema, name, "ros2msg" if message else "jsonschema", text))
            units = ", ".join(dict.fromkeys(port.units.values()))
            facts = {"port": port.name, "type": str(port.type), "unit": units, "direction": port.direction}
            if port.period:
                facts |= {"period": str(port.period), "offset": str(port.offset)}
            if message:
                facts |= {"offered_qos_profiles": ""}
            self._channels.append(mcap.channel(number, schema, topic, "cdr" if message else "json", facts))

    @property
    def can_retry(self) -> bool:
        """See ``Writer.can_retry``: the next chunk is written over one that has failed."""
        return self._seeks

    def write(self, blocks: Sequence[Block]) -> None:
        """See ``Writer.write``: the chunk, its indexes and a new end of the file, made in memory that is used again."""
        import numpy

        blocks = [block for block in blocks if len(block.time)]
        if not blocks:
            return
        chunk: FixedChunk | JsonChunk
        if self._encoding == "json":
            chunk = JsonChunk(blocks, [port.type for port in self._head.ports], self._counts)
        else:
            chunk = FixedChunk(blocks, self._fixed, [port.period for port in self._head.ports])
        index_start = mcap.CHUNK_HEAD + chunk.size
        size = index_start + sum(_HEAD_OF_INDEX + _INDEX_ENTRY * len(block.time) for block in blocks)
        tail = mcap.DATA_END + mcap.footer() if self._seeks else b""
        if len(self._room) < size + len(tail):
            self._room = numpy.empty((size + len(tail)) * 5 // 4, numpy.uint8)
        whole = memoryview(self._room)[: size + len(tail)]  # type: ignore[arg-type]
        chunk.write(self._room[mcap.CHUNK_HEAD : index_start], [self._counts[block.port] for block in blocks])
        first = min(int(block.time[0]) for block in blocks)
        last = max(int(block.time[-1]) for block in blocks)
        messages = whole[mcap.CHUNK_HEAD : index_start]
        whole[: mcap.CHUNK_HEAD] = mcap.chunk_head(messages, chunk.size, first, last)
        start, at = self._end, index_start
        indexes: dict[int, int] = {}
        for block, offsets in zip(blocks, chunk.offsets(), strict=True):
            indexes[block.port + 1] = start + at
            length = _INDEX_ENTRY * len(block.time)
            head = struct.pack("<BQHI", Opcode.MESSAGE_INDEX, 6 + length, block.port + 1, length)
            whole[at : at + _HEAD_OF_INDEX] = head
            at += _HEAD_OF_INDEX
            entries = self._room[at : at + length].view("<u8").reshape(-1, 2)
            entries[:, 0] = block.time
            entries[:, 1] = offsets
            at += length
        whole[size:] = tail
        if self._seeks:
            self._file.seek(start)
        self._file.write(whole)
        self._end += size
        counts = {block.port: len(block.time) for block in blocks}
        self._chunks.append(_Chunk(start, index_start, chunk.size, first, last, indexes, size - index_start, counts))
        for port, count in counts.items():
            self._counts[port] += count

    def _put(self, data: bytes) -> None:
        """Write records over the end of the file, and a new end: in one call, so the file is whole before and after."""
        if self._seeks:
            self._file.seek(self._end)
            self._file.write(data + mcap.DATA_END + mcap.footer())
        else:
            self._file.write(data)
        self._end += len(data)

    def close(self, ended: str, time: int) -> None:
        """See ``Writer.close``: writes the end of the run and the index."""
        end = mcap.metadata(END, {"ended": ended, "time": str(time)})
        end_start = self._end
        self._put(end)
        body = mcap.DATA_END
        summary_start = self._end + len(body)
        groups = [
            (Opcode.SCHEMA, b"".join(self._schemas)),
            (Opcode.CHANNEL, b"".join(self._channels)),
            (Opcode.STATISTICS, self._statistics()),
            (Opcode.CHUNK_INDEX, b"".join(map(_chunk_index, self._chunks))),
            (
                Opcode.METADATA_INDEX,
                _metadata_index(self._metadata_start, len(self._metadata), METADATA)
                + _metadata_index(end_start, len(end), END),
            ),
        ]
        offsets, position = [], summary_start
        for opcode, data in groups:
            if data:
                offsets.append(mcap.record(Opcode.SUMMARY_OFFSET, struct.pack("<BQQ", opcode, position, len(data))))
            position += len(data)
        summary = b"".join(data for _, data in groups)
        data = body + summary + b"".join(offsets) + mcap.footer(summary_start, position)
        if self._seeks:
            self._file.seek(self._end)
        self._file.write(data)

    def abandon(self) -> None:
        """See ``Writer.abandon``: cut the file after its last whole chunk, and, as far as there is room, end it."""
        if not self._seeks:
            return
        while True:
            self._file.truncate(self._end)
            try:
                self._file.seek(self._end)
                self._file.write(mcap.DATA_END + mcap.footer())
                return
            except OSError:
                if not self._chunks:
                    return
                lost = self._chunks.pop()
                self._end = lost.start
                for port, count in lost.counts.items():
                    self._counts[port] -= count

    def _statistics(self) -> bytes:
        first, last = self.span
        counts = {port + 1: count for port, count in self._counts.items() if count}
        content = struct.pack(
            "<QHIIIIQQ",
            sum(counts.values()),
            len(self._schemas),
            len(self._head.ports),
            0,
            2,
            len(self._chunks),
            first,
            last,
        )
        data = b"".join(struct.pack("<HQ", number, count) for number, count in counts.items())
        return mcap.record(Opcode.STATISTICS, content + struct.pack("<I", len(data)) + data)


def _chunk_index(chunk: _Chunk) -> bytes:
    indexes = b"".join(struct.pack("<HQ", number, place) for number, place in chunk.indexes.items())
    content = (
        struct.pack("<QQQQI", chunk.first, chunk.last, chunk.start, chunk.size, len(indexes))
        + indexes
        + struct.pack("<Q", chunk.index_size)
        + mcap.text("")
        + struct.pack("<QQ", chunk.content, chunk.content)
    )
    return mcap.record(Opcode.CHUNK_INDEX, content)


def _metadata_index(start: int, length: int, name: str) -> bytes:
    return mcap.record(Opcode.METADATA_INDEX, struct.pack("<QQ", start, length) + mcap.text(name))


class McapRecording(McapFile):
    """A recording that is one MCAP file."""

    def __init__(self, file: PartFile, head: RecordingHead, encoding: Encoding) -> None:
        super().__init__(file, head, encoding)
        self._part = file

    def close(self, ended: str, time: int) -> None:
        """See ``Writer.close``."""
        super().close(ended, time)
        self._part.put_in_place()

    def abandon(self) -> None:
        """See ``Writer.abandon``."""
        super().abandon()
        self._part.close()

    def discard(self) -> None:
        """See ``Writer.discard``."""
        self._part.discard()
