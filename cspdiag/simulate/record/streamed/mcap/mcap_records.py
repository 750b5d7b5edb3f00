"""The records of MCAP files (https://mcap.dev/spec, version 0) as bytes."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from typing_extensions import Buffer

MAGIC = b"\x89MCAP0\r\n"


HEAD_OF_MESSAGE = 31
"""The bytes of a message record before its data."""


class Opcode:
    """The first byte of each record."""

    HEADER = 1
    FOOTER = 2
    SCHEMA = 3
    CHANNEL = 4
    MESSAGE = 5
    CHUNK = 6
    MESSAGE_INDEX = 7
    CHUNK_INDEX = 8
    STATISTICS = 11
    METADATA = 12
    METADATA_INDEX = 13
    SUMMARY_OFFSET = 14
    DATA_END = 15


def record(opcode: int, content: bytes) -> bytes:
    """A record: opcode, length, content."""
    return struct.pack("<BQ", opcode, len(content)) + content


def text(value: str) -> bytes:
    """A string with its length."""
    data = value.encode()
    return struct.pack("<I", len(data)) + data


def texts(values: Mapping[str, str]) -> bytes:
    """A map of strings."""
    data = b"".join(text(key) + text(value) for key, value in values.items())
    return struct.pack("<I", len(data)) + data


def schema(number: int, name: str, encoding: str, definition: str) -> bytes:
    """A schema."""
    data = definition.encode()
    content = struct.pack("<H", number) + text(name) + text(encoding) + struct.pack("<I", len(data)) + data
    return record(Opcode.SCHEMA, content)


def channel(number: int, schema_number: int, topic: str, encoding: str, metadata: Mapping[str, str]) -> bytes:
    """A channel."""
    content = struct.pack("<HH", number, schema_number) + text(topic) + text(encoding) + texts(metadata)
    return record(Opcode.CHANNEL, content)


def metadata(name: str, values: Mapping[str, str]) -> bytes:
    """Metadata of the file."""
    return record(Opcode.METADATA, text(name) + texts(values))


CHUNK_HEAD = 49
"""The bytes of a chunk before its messages."""


def chunk_head(messages: Buffer, size: int, first: int, last: int) -> bytes:
    """The beginning of a chunk that is not compressed, with messages of this size between two instants."""
    content = struct.pack("<QQQI", first, last, size, zlib.crc32(messages)) + text("") + struct.pack("<Q", size)
    return struct.pack("<BQ", Opcode.CHUNK, len(content) + size) + content


def footer(summary_start: int = 0, offsets_start: int = 0) -> bytes:
    """The end of a file, with the magic bytes; without a summary for 0."""
    return record(Opcode.FOOTER, struct.pack("<QQI", summary_start, offsets_start, 0)) + MAGIC


DATA_END = record(Opcode.DATA_END, struct.pack("<I", 0))
