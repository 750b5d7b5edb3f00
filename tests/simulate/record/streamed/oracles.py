"""Recordings as other people's readers see them: for each port its instants in nanoseconds and its values, where a
struct or an array is the list of its numbers.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

Seen = dict[str, list[tuple[int, list[Any]]]]


def numbers(value: Any) -> Iterator[Any]:
    """The numbers of a value, in order."""
    if isinstance(value, dict):
        for part in value.values():
            yield from numbers(part)
    elif is_dataclass(value) and not isinstance(value, type):
        for field in fields(value):
            if not field.name.startswith("__") and not field.name.isupper():  # Constants of a definition.
                yield from numbers(getattr(value, field.name))
    elif hasattr(value, "tolist"):
        yield from numbers(value.tolist())
    elif isinstance(value, list | tuple):
        for part in value:
            yield from numbers(part)
    else:
        yield value


def by_mcap(path: Path) -> Seen:
    """By the reader of the package mcap, and for CDR the types of rosbags."""
    from mcap.reader import make_reader
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.EMPTY)
    found: Seen = {}
    with open(path, "rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            assert schema is not None
            if schema.encoding == "jsonschema":
                json.loads(schema.data)
                value: Any = json.loads(message.data)
            else:
                if schema.name not in store.fielddefs:
                    store.register(get_types_from_msg(schema.data.decode(), schema.name))
                value = store.deserialize_cdr(message.data, schema.name)
            found.setdefault(channel.metadata["port"], []).append((message.log_time, list(numbers(value))))
    return found


def by_rosbags(folder: Path, names: dict[str, str]) -> Seen:
    """By the reader of rosbags; ``names`` are the ports by topic."""
    from rosbags.highlevel import AnyReader

    found: Seen = {}
    with AnyReader([folder]) as reader:
        for connection, time, data in reader.messages():
            value = reader.deserialize(data, connection.msgtype)
            found.setdefault(names[connection.topic], []).append((time, list(numbers(value))))
    return found


def by_pyarrow(path: Path, columns: dict[str, list[str]]) -> Seen:
    """By pyarrow; ``columns`` are those of each port."""
    from pyarrow import parquet

    table = parquet.read_table(path).to_pydict()
    found: Seen = {}
    for port, own in columns.items():
        rows = [[table[name][row] for name in own] for row in range(len(table["time"]))]
        values = [
            (time, row) for time, row in zip(table["time"], rows, strict=True) if any(part is not None for part in row)
        ]
        if values:
            found[port] = values
    return found
