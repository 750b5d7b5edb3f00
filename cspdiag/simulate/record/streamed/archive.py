"""numpy archives of stored recordings."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any, BinaryIO, cast

from cspdiag.simulate.record.leaves import column
from cspdiag.simulate.record.stored.described import head_data
from cspdiag.simulate.record.stored.recording import StoredRecording
from cspdiag.simulate.record.streamed.part_file import PartFile, Sink

if TYPE_CHECKING:
    import numpy

    from cspdiag.simulate.record.streamed.blocks import Block


def write_archive(recording: StoredRecording, file: PartFile) -> None:
    """For each port ``NAME`` its values, and ``NAME.time`` its instants in seconds; types and units are in the comment
    of the archive.
    """
    from zipfile import ZipFile

    counts = dict.fromkeys(range(len(recording.head.ports)), 0)
    for blocks in recording.blocks():
        for block in blocks:
            counts[block.port] += len(block.time)
    with ZipFile(cast("BinaryIO", Stream(file)), "w") as archive:
        for position, port in enumerate(recording.head.ports):
            kind = column([], port.type)
            count = counts[position]
            _add(
                archive, port.name, (count, *kind.shape[1:]), kind.dtype, recording, position, lambda block: block.value
            )
            _add(archive, f"{port.name}.time", (count,), "f8", recording, position, _seconds)
        archive.comment = json.dumps(
            {"cspdiag": head_data(recording.head), "ended": recording.ended, "time": recording.time}
        ).encode()


def _seconds(block: Block) -> numpy.ndarray:
    seconds: numpy.ndarray = block.time.astype(float) / 1e9
    return seconds


def _add(
    archive: Any,
    name: str,
    shape: tuple[int, ...],
    kind: Any,
    recording: StoredRecording,
    position: int,
    part: Callable[[Block], numpy.ndarray],
) -> None:
    import numpy
    from numpy.lib import format as npy

    described = {"descr": npy.dtype_to_descr(numpy.dtype(kind)), "fortran_order": False, "shape": shape}
    with archive.open(f"{name}.npy", "w", force_zip64=True) as entry:
        npy.write_array_header_1_0(entry, described)
        for block in _of(recording, position):
            entry.write(numpy.ascontiguousarray(part(block)).tobytes())


def _of(recording: StoredRecording, position: int) -> Iterator[Block]:
    for blocks in recording.blocks((position,)):
        yield from blocks


class Stream:
    """A ``Sink`` as a file for ZipFile."""

    def __init__(self, sink: Sink) -> None:
        self._sink = sink
        self._place = 0

    def write(self, data: bytes) -> int:
        """Write all."""
        self._sink.write(data)
        self._place += len(data)
        return len(data)

    def tell(self) -> int:
        """The place."""
        if not self._sink.seekable():
            raise OSError("it has no places")
        return self._place

    def seek(self, place: int, whence: int = 0) -> int:
        """Go to a place, from the beginning."""
        if not self._sink.seekable() or whence:
            raise OSError("it has no places")
        self._sink.seek(place)
        self._place = place
        return place

    def flush(self) -> None:
        """Everything is written at once."""

    @property
    def closed(self) -> bool:
        """Who opened the sink closes it."""
        return False

    def close(self) -> None:
        """See ``closed``."""
