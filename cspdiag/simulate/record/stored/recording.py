"""A recording in a file: what it says of its signals, and their values, block by block."""

from __future__ import annotations

import struct
import zipfile
import zlib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from cspdiag.base.errors import CspdiagError
from cspdiag.base.record import record
from cspdiag.simulate.record.leaves import column, leaves
from cspdiag.simulate.record.stored.described import RecordingHead
from cspdiag.simulate.record.streamed.blocks import Block

if TYPE_CHECKING:
    import numpy

    from cspdiag.model.types import Type


class RecordingError(CspdiagError):
    """A file is no recording, or damaged; the message names it and says what helps."""


class InputsError(CspdiagError):
    """A recording does not have what the inputs or the parameters of a program need; the message names both."""


@contextmanager
def reading(path: str) -> Iterator[None]:
    """Raises RecordingError for what a file that is damaged, or was written by another tool, makes its reader raise."""
    try:
        yield
    except _OF_DAMAGED_FILES as problem:
        raise damaged(path, problem) from problem
    except OSError as problem:
        if problem.filename is not None:
            raise
        raise damaged(path, problem) from problem  # A place that is not in the file, or whatever else pyarrow found.


def damaged(path: str, problem: object) -> RecordingError:
    """The exception for a file that is damaged, from that of its reader, which may quote bytes of the file."""
    printable = "".join(character if character.isprintable() else " " for character in str(problem))
    account = " ".join(printable.split()).rstrip(".: ") or type(problem).__name__
    return RecordingError(f"{path} is damaged: {account}; record the run again")


_OF_DAMAGED_FILES = (
    *(ValueError, LookupError, TypeError, OverflowError, RuntimeError, MemoryError, EOFError),
    *(struct.error, zlib.error, zipfile.BadZipFile),
)


@record
class StoredRecording:
    """``read`` gives the blocks of the ports at some positions, part by part: each part has what comes after the parts
    before it. ``format`` is what the file is, for people; ``whole`` says whether it has the end of its run. ``ended``
    is why the run ended, and ``time`` when, in nanoseconds; of a recording that is not whole "", and the last instant.
    ``typed`` says whether the types and units are those of the program, or were guessed from the numbers; ``columns``
    are those of a table besides the time.
    """

    path: str
    format: str
    head: RecordingHead
    read: Callable[[Sequence[int]], Iterator[Sequence[Block]]]
    whole: bool = True
    ended: str = ""
    time: int = 0
    typed: bool = True
    columns: tuple[str, ...] = ()

    __hash__ = object.__hash__

    def blocks(self, positions: Sequence[int] | None = None) -> Iterator[Sequence[Block]]:
        """The values of the ports at these positions, or of all. Raises RecordingError if they are damaged."""
        with reading(self.path):
            yield from self.read(range(len(self.head.ports)) if positions is None else positions)

    def values(self, name: str) -> tuple[numpy.ndarray, numpy.ndarray]:
        """All instants in nanoseconds and all values of a port."""
        import numpy

        position = [port.name for port in self.head.ports].index(name)
        found = [block for blocks in self.blocks((position,)) for block in blocks]
        kind = self.head.ports[position].type
        return (
            numpy.concatenate([numpy.empty(0, numpy.int64), *(block.time for block in found)]),
            numpy.concatenate([column([], kind), *(block.value for block in found)]),
        )


def plain(values: numpy.ndarray) -> list[Any]:
    """Values as numbers, and lists of those for arrays and structs."""
    return [_plain(value) for value in values.tolist()]


def _plain(value: Any) -> Any:
    if hasattr(value, "tolist"):
        value = value.tolist()
    return [_plain(part) for part in value] if isinstance(value, list | tuple) else value


def assembled(numbers: Sequence[Any], kind: Type, count: int) -> numpy.ndarray:
    """Values from the columns of their numbers, in the order of ``leaves``."""
    import numpy

    empty = column([], kind)
    found = numpy.empty((count, *empty.shape[1:]), empty.dtype)
    for (_, _, path), values in zip(leaves("", kind), numbers, strict=True):
        into: Any = found
        for index in path:
            into = into[:, index] if into.ndim > 1 else into[(into.dtype.names or ())[index]]
        into[...] = values
    return found
