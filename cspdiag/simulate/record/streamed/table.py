"""CSV, row by row: a row for each instant at which a port had a new value, with values held in between."""

from __future__ import annotations

from array import array
from collections.abc import Sequence

from cspdiag.simulate.record.files import written
from cspdiag.simulate.record.held import Held, columns_of
from cspdiag.simulate.record.history import History
from cspdiag.simulate.record.stored.described import RecordingHead
from cspdiag.simulate.record.streamed.blocks import Block
from cspdiag.simulate.record.streamed.part_file import PartFile


class Table:
    """See ``Writer``."""

    can_retry = False
    """What fits is written, row by row."""

    def __init__(self, file: PartFile, head: RecordingHead) -> None:
        self._file = file
        self._head = head
        self._columns = [
            column for port in head.ports for column in columns_of(port.name, port.name, port.type, written)
        ]
        self._held = Held(self._columns, "")
        self._size = 0
        self._put(",".join(["time", *(column.name for column in self._columns)]) + "\n")

    def write(self, blocks: Sequence[Block]) -> None:
        """See ``Writer.write``."""
        histories = {
            self._head.ports[block.port].name: History(block.time, block.value, array("q")) for block in blocks
        }
        for instants, cells in self._held.rows(histories):
            self._put(table_rows(instants, cells))

    def _put(self, text: str) -> None:
        data = text.encode()
        self._file.write(data)
        self._size += len(data)

    def close(self, ended: str, time: int) -> None:
        """See ``Writer.close``."""
        self._file.put_in_place()

    def abandon(self) -> None:
        """See ``Writer.abandon``: what is there ends with a whole row."""
        if self._file.seekable():
            self._file.truncate(self._size)
        self._file.close()

    def discard(self) -> None:
        """See ``Writer.discard``."""
        self._file.discard()


def table_rows(instants: Sequence[int], cells: Sequence[Sequence[str]]) -> str:
    """Rows of a table, with times in seconds."""
    times = [repr(instant / 1e9) for instant in instants]
    return "\n".join(map(",".join, zip(times, *cells, strict=True))) + "\n"
