"""A run as a table: a row for each instant at which a value was passed, with values held in between."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar

from cspdiag.simulate.record.leaves import leaves

if TYPE_CHECKING:
    from cspdiag.model.types import Type
    from cspdiag.simulate.record.run_data import RunData

Cell = TypeVar("Cell")


class Column(NamedTuple, Generic[Cell]):
    """One number of a channel: the channel's hierarchical ``path``, and how its value becomes a cell."""

    path: str
    name: str
    type: Type
    cell: Callable[[Any], Cell]


def columns_of(path: str, name: str, type_: Type, cell: Callable[[Any, Type], Cell]) -> list[Column[Cell]]:
    """A column for each number that the values of a channel consist of: ``gyro[0]``, ``pose.x``."""

    def of_leaf(kind: Type, pick: Callable[[Any], Any]) -> Callable[[Any], Cell]:
        return lambda value: cell(pick(value), kind)

    return [Column(path, leaf, kind, of_leaf(kind, pick)) for leaf, kind, pick in leaves(name, type_)]


def held_rows(run: RunData, columns: Iterable[Column[Cell]], empty: Cell) -> Iterator[tuple[int, list[Cell]]]:
    """The instants in nanoseconds with their rows, in which a cell is ``empty`` before its first value. The same list
    object is returned each time.
    """
    written: dict[str, list[tuple[int, Callable[[Any], Cell]]]] = {}
    row: list[Cell] = []
    for column in columns:
        written.setdefault(column.path, []).append((len(row), column.cell))
        row.append(empty)
    instant: int | None = None
    for time, channel, value in run.values_passed():
        own = written.get(channel)
        if own is None:
            continue
        if instant is not None and time != instant:
            yield instant, row
        instant = time
        for position, cell in own:
            row[position] = cell(value)
    if instant is not None:
        yield instant, row
