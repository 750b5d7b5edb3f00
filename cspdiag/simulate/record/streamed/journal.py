"""Formats that can only be written at the end (npz, Parquet): until then the values are in an MCAP file next to it,
from which they are taken block by block.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence

from cspdiag.simulate.record.stored.described import RecordingHead
from cspdiag.simulate.record.stored.recording import StoredRecording
from cspdiag.simulate.record.streamed.blocks import Block
from cspdiag.simulate.record.streamed.mcap.mcap_file import McapFile
from cspdiag.simulate.record.streamed.part_file import PartFile, journal_name

Converter = Callable[[StoredRecording, PartFile], None]
"""Writes a stored recording to a file, in bounded memory."""


class Journal:
    """See ``Writer``."""

    def __init__(self, path: str, head: RecordingHead, convert: Converter) -> None:
        self._path = path
        self._convert = convert
        self._target = PartFile(path) if os.path.exists(path) and not os.path.isfile(path) else None
        """A device or a pipe is opened at once: it may have no reader."""
        name = journal_name(path)
        self._file = PartFile(name, name)
        self._mcap = McapFile(self._file, head, "ros2")

    @property
    def part(self) -> str:
        """The name of the journal, for messages."""
        return self._file.part

    @property
    def can_retry(self) -> bool:
        """See ``Writer.can_retry``."""
        return self._mcap.can_retry

    def write(self, blocks: Sequence[Block]) -> None:
        """See ``Writer.write``."""
        self._mcap.write(blocks)

    def close(self, ended: str, time: int) -> None:
        """See ``Writer.close``."""
        from cspdiag.simulate.record.stored.mcap_reader import open_mcap

        self._mcap.close(ended, time)
        target = self._target or PartFile(self._path)
        try:
            self._convert(open_mcap(self._file.part), target)
        except BaseException:
            target.discard()
            raise
        target.put_in_place()
        self._file.discard()

    def abandon(self) -> None:
        """See ``Writer.abandon``."""
        if self._target is not None:
            self._target.close()
        self._mcap.abandon()
        self._file.close()

    def discard(self) -> None:
        """See ``Writer.discard``."""
        if self._target is not None:
            self._target.discard()
        self._file.discard()
