"""Rows that repeat but for numbers that count: where they are, and any number of them made at once.

A row is a record of the network, a tuple or a number; indexes in names (``cell[3].output``) are numbers of it, too.
"""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Hashable, Iterable, Iterator, Sequence
from itertools import repeat
from typing import Any, TypeAlias

from cspdiag.base import Span
from cspdiag.base.record import Slotted, field_names, is_record, record

LEAST_ROUNDS = 3
"""Rows that repeat less often may look alike by chance."""

LONGEST_ROUND = 12
"""Rows: the relationships of one step of a ``for``, for example."""

INDEX = re.compile(r"(?<=\[)\d+(?=\])")

Numbers: TypeAlias = Sequence[tuple[int, int]]
"""The numbers of a row, each with its step from one round to the next."""

_take_all = deque[object](maxlen=0).extend


@record
class Outline:
    """A row as its numbers and the rest."""

    shape: Hashable
    numbers: tuple[int, ...]


@record
class Run:
    """``rounds`` rounds of rows; in each, the numbers of a row are by its ``steps`` greater than in the one before."""

    rows: tuple[Any, ...]
    """Those of the first round."""
    outlines: tuple[Outline, ...]
    steps: tuple[tuple[int, ...], ...]
    rounds: int


def runs(rows: Sequence[Any]) -> Iterator[Run]:
    """The rows as runs, each as long as possible; a row that does not repeat is a run of one round."""
    outlines = [outline(row) for row in rows]
    start = 0
    while start < len(rows):
        length, rounds = 1, 1
        for candidate in range(1, min(LONGEST_ROUND, (len(rows) - start) // LEAST_ROUNDS) + 1):
            count = _rounds(outlines, start, candidate)
            if count >= LEAST_ROUNDS and count * candidate > length * rounds:
                length, rounds = candidate, count
        first = outlines[start : start + length]
        following = outlines[start + length : start + 2 * length] if rounds > 1 else first
        steps = tuple(_difference(one, other) for one, other in zip(first, following, strict=True))
        yield Run(tuple(rows[start : start + length]), tuple(first), steps, rounds)
        start += length * rounds


def _rounds(outlines: Sequence[Outline], start: int, length: int) -> int:
    """How often the rows from ``start`` on repeat in rounds of this length."""
    place = start + length
    steps: list[tuple[int, ...]] = []
    while place < len(outlines) and outlines[place].shape == outlines[place - length].shape:
        step = _difference(outlines[place - length], outlines[place])
        if len(steps) < length:
            steps.append(step)
        elif step != steps[(place - start) % length]:
            break
        place += 1
    return (place - start) // length


def _difference(one: Outline, other: Outline) -> tuple[int, ...]:
    return tuple([after - before for before, after in zip(one.numbers, other.numbers, strict=True)])


def outline(row: object) -> Outline:
    """The outline of a row."""
    numbers: list[int] = []
    return Outline(_shape(row, numbers), tuple(numbers))


def _shape(item: Any, numbers: list[int]) -> Hashable:
    kind = type(item)
    if kind is int:
        numbers.append(item)
        return int
    if kind is str:
        found = INDEX.findall(item)
        numbers += map(int, found)
        return INDEX.sub("", item) if found else item
    if kind is tuple:
        return tuple([_shape(inner, numbers) for inner in item])
    if kind is not Span and is_record(item):
        return (kind, *[_shape(getattr(item, name), numbers) for name in field_names(item)])
    return kind, item


def rows_like(row: Any, numbers: Numbers, count: int) -> Iterable[Any]:
    """A row for each round: like the row, with these numbers in the first one."""
    return _all(row, _column(row, iter(numbers), count), count)


def _all(item: Any, column: Iterable[Any] | None, count: int) -> Iterable[Any]:
    return repeat(item, count) if column is None else column


def _column(item: Any, numbers: Iterator[tuple[int, int]], count: int) -> Iterable[Any] | None:
    """What is in the place of an item, row by row; None if it is the item itself in all of them."""
    kind = type(item)
    if kind is int:
        first, step = next(numbers)
        return None if first == item and step == 0 else _counting(first, step, count)
    if kind is str:
        texts = INDEX.split(item.replace("{", "{{").replace("}", "}}"))
        counting = [_counting(*next(numbers), count) for _ in texts[1:]]
        return map("{}".join(texts).format, *counting) if counting else None
    if kind is tuple:
        columns = [_column(inner, numbers, count) for inner in item]
        if all(column is None for column in columns):
            return None
        return zip(*map(_all, item, columns, repeat(count)), strict=True)
    if kind is Span or not is_record(item):
        return None
    names = field_names(item)
    fields = [getattr(item, name) for name in names]
    columns = [_column(field, numbers, count) for field in fields]
    if all(column is None for column in columns):
        return None
    values = [*map(_all, fields, columns, repeat(count))]
    if not issubclass(kind, Slotted):
        return [kind(**dict(zip(names, row, strict=True))) for row in zip(*values, strict=True)]
    made = list(map(kind.__new__, repeat(kind, count)))
    for store, column in zip(kind.__record_stores__, values, strict=True):
        _take_all(map(store, made, column))
    return made


def _counting(first: int, step: int, count: int) -> Iterable[int]:
    return range(first, first + step * count, step) if step else repeat(first, count)
