"""The messages of a chunk whose sizes are known: they are written into its memory where they belong, without a step in
between for each of them.

Ports that are sampled together have their messages next to each other at every tick, so a tick is one row of bytes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from cspdiag.base.record import record
from cspdiag.model.types import Type
from cspdiag.simulate.record.leaves import leaf_of_each, leaves
from cspdiag.simulate.record.streamed.blocks import Block
from cspdiag.simulate.record.streamed.mcap.mcap_records import HEAD_OF_MESSAGE, Opcode
from cspdiag.simulate.record.streamed.mcap.messages import Message, header

if TYPE_CHECKING:
    import numpy

_LONGEST_CYCLE = 20
_SEEN = 64
"""How many rows are compared to find a cycle."""


class FixedMessages:
    """The messages of the port at a position, each of ``size`` bytes."""

    def __init__(self, position: int, message: Message, kind: Type) -> None:
        import numpy

        self.size = HEAD_OF_MESSAGE + message.size
        self._paths = [path for _, _, path in leaves("", kind)]
        names = [f"f{position}" for position in range(len(self._paths))]
        offsets = [HEAD_OF_MESSAGE + len(header()) + offset for offset in message.offsets]
        self._layout = numpy.dtype(
            {
                "names": ["op", "n", "ch", "seq", "log", "pub", *names],
                "formats": ["u1", "<u8", "<u2", "<u4", "<u8", "<u8", *message.codes],
                "offsets": [0, 1, 9, 11, 15, 23, *offsets],
                "itemsize": self.size,
            }
        )
        self.template = numpy.zeros(self.size, numpy.uint8)
        """What all messages have in common."""
        first = self.template.view(self._layout)
        first["op"], first["n"], first["ch"] = Opcode.MESSAGE, self.size - 9, position + 1
        self.template[HEAD_OF_MESSAGE : HEAD_OF_MESSAGE + len(header())] = numpy.frombuffer(header(), numpy.uint8)

    def fill(self, rows: numpy.ndarray, numbers: numpy.ndarray, time: numpy.ndarray, values: numpy.ndarray) -> None:
        """Write the messages with these numbers into rows of bytes of shape ``(n, size)``, which have the template."""
        into = rows.view(self._layout)[:, 0]
        into["seq"] = numbers & 0xFFFFFFFF
        into["log"] = time
        into["pub"] = time
        for position, path in enumerate(self._paths):
            into[f"f{position}"] = leaf_of_each(values, path)


@record
class _Piece:
    """Values of a block from ``begin`` on."""

    block: int
    begin: int
    time: numpy.ndarray
    value: numpy.ndarray


@record
class _Group:
    """Pieces with equal instants; a row has a message of each."""

    pieces: tuple[_Piece, ...]
    sizes: tuple[int, ...]

    @property
    def time(self) -> numpy.ndarray:
        """The instants."""
        return self.pieces[0].time


class FixedChunk:
    """The messages of some blocks in order of time: ``size`` bytes in all."""

    def __init__(self, blocks: Sequence[Block], ports: Sequence[FixedMessages], periods: Sequence[int]) -> None:
        self._blocks = blocks
        self._ports = ports
        self._groups = [
            _Group(pieces, tuple(ports[blocks[piece.block].port].size for piece in pieces))
            for pieces in _grouped(blocks, periods)
        ]
        self._starts = _starts(self._groups)
        self.size = sum(ports[block.port].size * len(block.time) for block in blocks)

    def offsets(self) -> list[numpy.ndarray]:
        """Where each message of each block is."""
        import numpy

        found = [numpy.empty(len(block.time), numpy.int64) for block in self._blocks]
        for group, starts in zip(self._groups, self._starts, strict=True):
            at = 0
            for piece, size in zip(group.pieces, group.sizes, strict=True):
                found[piece.block][piece.begin : piece.begin + len(piece.time)] = starts + at
                at += size
        return found

    def write(self, into: numpy.ndarray, numbers: Sequence[int]) -> None:
        """Write the messages; ``numbers`` are those of the first message of each block."""
        import numpy
        from numpy.lib.stride_tricks import as_strided

        for group, starts in zip(self._groups, self._starts, strict=True):
            size = sum(group.sizes)
            for begin, end, cycle in _regular_parts(starts):
                if not cycle:
                    rows = numpy.empty((end - begin, size), numpy.uint8)
                    self._fill(rows, group, slice(begin, end), numbers)
                    into[starts[begin:end, None] + numpy.arange(size)] = rows
                for first in range(begin, min(begin + cycle, end)):
                    own = starts[first:end:cycle]
                    distance = int(own[1] - own[0]) if len(own) > 1 else size
                    rows = as_strided(into[int(own[0]) :], (len(own), size), (distance, 1))
                    self._fill(rows, group, slice(first, end, cycle), numbers)

    def _fill(self, rows: numpy.ndarray, group: _Group, chosen: slice, numbers: Sequence[int]) -> None:
        """Write some rows of a group, of shape ``(n, size)``."""
        import numpy

        ports = [self._ports[self._blocks[piece.block].port] for piece in group.pieces]
        # One copy for each row takes a fraction of one for each message.
        rows[...] = numpy.concatenate([port.template for port in ports])
        at = 0
        for piece, port in zip(group.pieces, ports, strict=True):
            first = numbers[piece.block] + piece.begin
            sequence = numpy.arange(first, first + len(piece.time))[chosen]
            port.fill(rows[:, at : at + port.size], sequence, piece.time[chosen], piece.value[chosen])
            at += port.size


def _regular_parts(starts: numpy.ndarray) -> Iterator[tuple[int, int, int]]:
    """The rows in parts, each from a row up to another one, with the number of rows after which the distances between
    rows repeat: 1 for one sample period, a few for two; 0 for some rows without such a number.
    """
    import numpy

    begin = 0
    while begin < len(starts):
        seen = starts[begin : begin + _SEEN]
        cycle = _cycle(seen)
        end = begin + len(seen)
        if cycle and end < len(starts):
            distances = starts[begin + cycle :] - starts[begin:-cycle]
            others = numpy.flatnonzero(distances != distances[0])
            end = begin + cycle + int(others[0]) if len(others) else len(starts)
        yield begin, end, cycle
        begin = end


def _cycle(starts: numpy.ndarray) -> int:
    for cycle in range(1, min(_LONGEST_CYCLE, len(starts)) + 1):
        distances = starts[cycle:] - starts[:-cycle]
        if not len(distances) or (distances == distances[0]).all():
            return cycle
    return 0


def _grouped(blocks: Sequence[Block], periods: Sequence[int]) -> list[tuple[_Piece, ...]]:
    """The values of all blocks, those of ports with the same ticks together."""
    same: dict[int, list[int]] = {}
    for at, block in enumerate(blocks):
        same.setdefault(periods[block.port] or -at - 1, []).append(at)
    groups: list[tuple[_Piece, ...]] = []
    for found in same.values():
        groups += _together([blocks[at] for at in found], found)
    return sorted(groups, key=lambda pieces: pieces[0].block)


def _together(blocks: Sequence[Block], numbers: Sequence[int]) -> list[tuple[_Piece, ...]]:
    """A group for the instants that all blocks have, and each for itself for those before and after them."""
    import numpy

    first, last = max(int(block.time[0]) for block in blocks), min(int(block.time[-1]) for block in blocks)
    spans = [
        (int(numpy.searchsorted(block.time, first)), int(numpy.searchsorted(block.time, last, side="right")))
        for block in blocks
    ]
    common = [block.time[begin:end] for block, (begin, end) in zip(blocks, spans, strict=True)]
    if first > last or not all(numpy.array_equal(common[0], other) for other in common[1:]):
        return [(_Piece(number, 0, block.time, block.value),) for number, block in zip(numbers, blocks, strict=True)]

    def piece(at: int, begin: int, end: int) -> _Piece:
        return _Piece(numbers[at], begin, blocks[at].time[begin:end], blocks[at].value[begin:end])

    together = tuple(piece(at, begin, end) for at, (begin, end) in enumerate(spans))
    around = [
        (piece(at, begin, end),)
        for at, span in enumerate(spans)
        for begin, end in ((0, span[0]), (span[1], len(blocks[at].time)))
        if end > begin
    ]
    return [together, *around]


def _starts(groups: Sequence[_Group]) -> list[numpy.ndarray]:
    """Where each row of each group begins, in order of time; at equal instants in order of the groups."""
    import numpy

    sizes = numpy.concatenate([numpy.full(len(group.time), sum(group.sizes)) for group in groups])
    if len(groups) == 1:
        return [numpy.cumsum(sizes) - sizes]
    order = numpy.argsort(numpy.concatenate([group.time for group in groups]), kind="stable")
    starts = numpy.empty(len(order), numpy.int64)
    in_time = sizes[order]
    starts[order] = numpy.cumsum(in_time) - in_time
    return numpy.split(starts, numpy.cumsum([len(group.time) for group in groups])[:-1])
