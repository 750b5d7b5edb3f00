"""Values on their way to a file: blocks of one port, cut at common instants."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, Protocol

from cspdiag.base.record import record

if TYPE_CHECKING:
    import numpy

    from cspdiag.model.types import Type


@record
class Block:
    """Values of the port at this position: instants in nanoseconds, ascending, of shape ``(n,)``, and as many values,
    an array as ``leaves.column`` makes them.
    """

    port: int
    time: numpy.ndarray
    value: numpy.ndarray


class Writer(Protocol):
    """What writes the blocks of a recording to a file; every method raises OSError as the file system does."""

    @property
    def can_retry(self) -> bool:
        """Whether a ``write`` that has failed has changed nothing, so that a part of it may be written instead."""
        ...

    def write(self, blocks: Sequence[Block]) -> None:
        """Write the values of some time, so that they are there if the process is killed now. No block has values
        before the last ones of earlier calls.
        """
        ...

    def close(self, ended: str, time: int) -> None:
        """The run ended, for this reason, at this instant: complete the file."""
        ...

    def abandon(self) -> None:
        """Nothing more can be written: leave what is readable."""
        ...

    def discard(self) -> None:
        """There was no run: leave nothing."""
        ...


def array_of(values: Any, kind: Type) -> numpy.ndarray:
    """Values that were noted during a run, as an array of their type."""
    from array import array

    import numpy

    from cspdiag.simulate.record.leaves import column

    if isinstance(values, array):
        found: numpy.ndarray = numpy.array(values).astype(column([], kind).dtype, copy=False)
        return found
    return column(values, kind) if isinstance(values, list) else values


class Pending:
    """Values of all ports that were added and not yet written."""

    def __init__(self, count: int) -> None:
        self._parts: list[list[tuple[numpy.ndarray, numpy.ndarray]]] = [[] for _ in range(count)]
        self.last: dict[int, Any] = {}
        """The last value of each port that has one, as an array of length 1."""

    def add(self, port: int, time: numpy.ndarray, value: numpy.ndarray) -> None:
        """Add values of a port, later than those before or at the same instant."""
        if len(time):
            self._parts[port].append((time, value))
            self.last[port] = value[-1:]

    def before(self, instant: int | None) -> list[Block]:
        """Take the values before an instant, or all."""
        import numpy

        found = []
        for port, parts in enumerate(self._parts):
            if not parts:
                continue
            time = numpy.concatenate([part for part, _ in parts]) if len(parts) > 1 else parts[0][0]
            value = numpy.concatenate([part for _, part in parts]) if len(parts) > 1 else parts[0][1]
            end = len(time) if instant is None else int(numpy.searchsorted(time, instant))
            self._parts[port] = [(time[end:], value[end:])] if end < len(time) else []
            if end:
                found.append(Block(port, time[:end], value[:end]))
        return found


MOST_AT_ONCE = 20_000
"""How many values of a port are written in one go, at most, unless more are of one instant."""


def in_pieces(blocks: Sequence[Block]) -> Iterator[Sequence[Block]]:
    """The blocks cut at common instants, so that a disk that becomes full has all but the last few values."""
    import numpy

    begins = [0] * len(blocks)
    while True:
        rest = [len(block.time) - begin for block, begin in zip(blocks, begins, strict=True)]
        longest = rest.index(max(rest))
        if rest[longest] <= MOST_AT_ONCE:
            ends = [len(block.time) for block in blocks]
        else:
            last = blocks[longest].time[begins[longest] + MOST_AT_ONCE - 1]
            ends = [int(numpy.searchsorted(block.time, last, side="right")) for block in blocks]
        yield [
            Block(block.port, block.time[begin:end], block.value[begin:end])
            for block, begin, end in zip(blocks, begins, ends, strict=True)
            if end > begin
        ]
        begins = ends
        if all(begin == len(block.time) for block, begin in zip(blocks, begins, strict=True)):
            return


def halved(blocks: Sequence[Block]) -> tuple[Sequence[Block], Sequence[Block]] | None:
    """Blocks cut in two at a common instant; None if all values are of one instant."""
    import numpy

    instants = numpy.unique(numpy.concatenate([block.time for block in blocks]))
    if len(instants) < 2:
        return None
    ends = [int(numpy.searchsorted(block.time, instants[len(instants) // 2])) for block in blocks]
    pairs = list(zip(blocks, ends, strict=True))
    return (
        [Block(block.port, block.time[:end], block.value[:end]) for block, end in pairs if end],
        [Block(block.port, block.time[end:], block.value[end:]) for block, end in pairs if end < len(block.time)],
    )


def in_order(blocks: Sequence[Block]) -> numpy.ndarray:
    """The order in time of the values of all blocks, one after the other; those of an instant as the blocks are."""
    import numpy

    return numpy.argsort(numpy.concatenate([block.time for block in blocks]), kind="stable")
