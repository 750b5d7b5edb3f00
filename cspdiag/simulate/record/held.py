"""A run as a table: a row for each instant at which a value was passed, with values held in between."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar

from cspdiag.simulate.record.leaves import Path, leaves

if TYPE_CHECKING:
    from cspdiag.model.types import Type
    from cspdiag.simulate.record.history import History

Cell = TypeVar("Cell")

_ROWS = 1 << 14
"""The most values of a channel that become cells at a time: a table may be longer than the memory has room for."""


class Column(NamedTuple, Generic[Cell]):
    """One number of a channel: the channel's hierarchical name, where the number is in a value, and how values become
    cells.
    """

    channel: str
    name: str
    type: Type
    path: Path
    cells: Callable[[list[Any], Type], list[Cell]]


def columns_of(
    channel: str, name: str, type_: Type, cells: Callable[[list[Any], Type], list[Cell]]
) -> list[Column[Cell]]:
    """A column for each number that the values of a channel consist of: ``gyro[0]``, ``pose.x``."""
    return [Column(channel, leaf, kind, path, cells) for leaf, kind, path in leaves(name, type_)]


def held_rows(
    histories: Mapping[str, History], columns: Sequence[Column[Cell]], empty: Cell
) -> Iterator[tuple[list[int], list[list[Cell]]]]:
    """Parts of the table, one after the other: instants in nanoseconds, and for each column its cells, which are
    ``empty`` before the first value.
    """
    yield from Held(columns, empty).rows(histories)


class Held(Generic[Cell]):
    """The table so far: what is held in each column after the last row."""

    def __init__(self, columns: Sequence[Column[Cell]], empty: Cell) -> None:
        self._columns = columns
        self._held = [empty] * len(columns)

    def rows(self, histories: Mapping[str, History]) -> Iterator[tuple[list[int], list[list[Cell]]]]:
        """The rows that follow, in parts, from what the channels passed since."""
        channels = [name for name in dict.fromkeys(column.channel for column in self._columns) if name in histories]
        shown = {name: histories[name] for name in channels}
        starts = dict.fromkeys(channels, 0)
        while ends := _ends(shown, starts):
            instants = sorted(
                {time for name in channels for time in shown[name].time[starts[name] : ends[name]].tolist()}
            )
            cells = []
            for position, column in enumerate(self._columns):
                new: dict[int, Cell] = {}
                if column.channel in shown:
                    own, start, stop = shown[column.channel], starts[column.channel], ends[column.channel]
                    values = column.cells(own.leaf(column.path, start, stop), column.type)
                    new = dict(zip(own.time[start:stop].tolist(), values, strict=True))
                cells.append(_held(self._held[position], instants, new))
                self._held[position] = cells[-1][-1]
            yield instants, cells
            starts = ends


def _ends(histories: Mapping[str, History], starts: Mapping[str, int]) -> dict[str, int]:
    """Where a part ends in each history, between two instants; nothing if all is done."""
    rest = [name for name, own in histories.items() if starts[name] < len(own.time)]
    last = [own.time[starts[name] + _ROWS] for name, own in histories.items() if starts[name] + _ROWS < len(own.time)]
    if not last:
        return {name: len(own.time) for name, own in histories.items()} if rest else {}
    until = max(min(last), 1 + min(int(histories[name].time[starts[name]]) for name in rest))
    return {name: bisect_left(own.time, until, starts[name]) for name, own in histories.items()}


def _held(last: Cell, instants: list[int], new: Mapping[int, Cell]) -> list[Cell]:
    """A cell for each instant: the new one, or the last one before."""
    cells = []
    find = new.get
    for instant in instants:
        last = find(instant, last)
        cells.append(last)
    return cells
