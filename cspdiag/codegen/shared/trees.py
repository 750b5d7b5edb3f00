"""Trees of generated code: traversal, and repetition in parts that differ only in numbers."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from functools import cache
from types import NoneType
from typing import Any, TypeVar, cast, overload

from cspdiag.base.record import ATOMS, annotations_of, field_names, is_record, record, replaced
from cspdiag.network.elaborate.fewer.rows import Rows, repetitions

T = TypeVar("T")

LEAST = 3
"""Fewer parts than this are not rolled into a loop."""

LONGEST = 4
"""The largest number of different parts in one iteration of a loop."""


class Counted:
    """A number that may count: nodes are alike if they differ only in their ``value``."""

    value: int


class Closed:
    """A node in which no number counts, because it counts or names something itself: only equal nodes are alike."""


@record
class Outline:
    """The structure of a tree: trees of one ``shape`` differ only in ``numbers``."""

    shape: Hashable
    numbers: tuple[int, ...]


@record
class Stretch:
    """``count`` outlines of one shape in sequence, of which each number changes by its step from one to the next."""

    shape: Hashable
    numbers: tuple[int, ...]
    """Those of the first."""
    steps: tuple[int, ...]
    count: int

    def numbers_at(self, position: int) -> tuple[int, ...]:
        """Those of the outline at a position."""
        return tuple([number + step * position for number, step in zip(self.numbers, self.steps, strict=True)])

    def first(self) -> Stretch:
        """The first outline alone."""
        return _single(self.shape, self.numbers)

    def after_first(self) -> Stretch:
        """All others."""
        if self.count == 2:
            return _single(self.shape, self.numbers_at(1))
        return Stretch(self.shape, self.numbers_at(1), self.steps, self.count - 1)


def _single(shape: Hashable, numbers: tuple[int, ...]) -> Stretch:
    return Stretch(shape, numbers, (0,) * len(numbers), 1)


def stretches(outlines: Iterable[Outline]) -> list[Stretch]:
    """The outlines as stretches, each as long as it can be from the left."""
    found: list[Stretch] = []
    shape: Hashable = None
    first: tuple[int, ...] = ()
    last: tuple[int, ...] = ()
    steps: list[int] = []
    count = 0
    for entry in outlines:
        if count and entry.shape == shape:
            change = [after - before for before, after in zip(last, entry.numbers, strict=True)]
            if count == 1 or change == steps:
                steps, last = change, entry.numbers
                count += 1
                continue
        if count:
            found.append(Stretch(shape, first, tuple(steps), count))
        shape, first, last, count = entry.shape, entry.numbers, entry.numbers, 1
        steps = [0] * len(first)
    if count:
        found.append(Stretch(shape, first, tuple(steps), count))
    return found


class OutlinesOfRows(Sequence[Outline]):
    """The outlines of rows of which it is known where they repeat: few are made."""

    def __init__(self, rows: Sequence[T], outlined: Callable[[T], Outline]) -> None:
        self._starts: list[int] = []
        self._parts: list[tuple[Sequence[Stretch], int] | list[Outline]] = []
        """For a repetition the outlines in each place of a round, and the number of rounds."""
        self._size = len(rows)
        for repetition in repetitions(rows):
            self._starts.append(repetition.start)
            strands = repetition.strands() if repetition.rounds > 1 else ()
            found = [_stretch(strand.of(rows), outlined) for strand in strands]
            known = [stretch for stretch in found if stretch is not None]
            if known and len(known) == len(found):
                self._parts.append((known, repetition.rounds))
            else:
                self._parts.append(list(map(outlined, repetition.of(rows))))

    def __len__(self) -> int:
        return self._size

    @overload
    def __getitem__(self, position: int) -> Outline: ...
    @overload
    def __getitem__(self, position: slice) -> Sequence[Outline]: ...
    def __getitem__(self, position: int | slice) -> Outline | Sequence[Outline]:
        if isinstance(position, slice):
            return [self[at] for at in range(*position.indices(len(self)))]
        if not 0 <= position < len(self):
            raise IndexError(position)
        number = bisect_right(self._starts, position) - 1
        part, place = self._parts[number], position - self._starts[number]
        if isinstance(part, list):
            return part[place]
        turn, at = divmod(place, len(part[0]))
        return Outline(part[0][at].shape, part[0][at].numbers_at(turn))

    def times(self, start: int, period: int) -> int:
        """How often ``period`` outlines are known to repeat from ``start`` on; 1 if nothing is known."""
        number = bisect_right(self._starts, start) - 1
        part = self._parts[number]
        if isinstance(part, list) or period % len(part[0]):
            return 1
        return max(1, (self._starts[number] + len(part[0]) * part[1] - start) // period)


def outlines_of(rows: Sequence[T], outlined: Callable[[T], Outline]) -> Sequence[Outline]:
    """The outlines of rows. All that an outline says of its row is in the row: rows that differ in numbers that count
    have outlines that do.
    """
    return OutlinesOfRows(rows, outlined) if isinstance(rows, Rows) else list(map(outlined, rows))


def stretches_of(parts: Iterable[Sequence[T]], outlined: Callable[[T], Outline]) -> list[Stretch]:
    """The same, as stretches, of rows in parts that are known to differ in numbers that count."""
    found: list[Stretch] = []
    for part in parts:
        known = _stretch(part, outlined)
        found += stretches(map(outlined, part)) if known is None else [known]
    return found


def _stretch(rows: Sequence[T], outlined: Callable[[T], Outline]) -> Stretch | None:
    """The outlines of rows that differ in numbers that count, of which three are made; None if the outlines do not."""
    first, second, last = outlined(rows[0]), outlined(rows[min(1, len(rows) - 1)]), outlined(rows[-1])
    if not first.shape == second.shape == last.shape:
        return None
    steps = tuple([after - before for before, after in zip(first.numbers, second.numbers, strict=True)])
    known = Stretch(first.shape, first.numbers, steps, len(rows))
    return known if known.numbers_at(len(rows) - 1) == last.numbers else None


def nodes(item: object) -> Iterator[object]:
    """All nodes of a tree, of expressions and of statements."""
    pending = [item]
    while pending:
        part = pending.pop()
        if isinstance(part, (tuple, list)):
            pending += reversed(part)
            continue
        kind: type = type(part)
        names = _searched_fields(kind)
        if names is not None:
            yield part
            pending += [getattr(part, name) for name in names]


@cache
def _searched_fields(kind: type) -> tuple[str, ...] | None:
    """The fields of a node in which others may be, the last one first; None for everything else."""
    if not hasattr(kind, "__record_fields__"):
        return None
    kinds = annotations_of(kind)
    return tuple([name for name in reversed(kind.__record_fields__) if kinds[name] not in ATOMS])


def outline(item: object) -> Outline:
    """The outline of a tree, or of several in a tuple."""
    numbers: list[int] = []
    shape = _shape(item, numbers)
    return Outline(shape, tuple(numbers))


def _shape(item: object, numbers: list[int]) -> Hashable:
    if type(item) is tuple:
        return tuple([part if type(part) in _PLAIN else _shape(part, numbers) for part in item])
    kind: type = type(item)
    shape = _shape_of(kind)
    if shape is None:
        return item
    return shape(item, numbers)


@cache
def _shape_of(kind: type) -> Callable[[object, list[int]], Hashable] | None:
    """The shape of a node of one kind, made for its fields, as it is called for each node; None for everything else."""
    names: tuple[str, ...] | None = getattr(kind, "__record_fields__", None)
    if names is None or issubclass(kind, Closed):
        return None
    if issubclass(kind, Counted):
        noted = "    numbers.append(item.value)\n"
        parts = [f"item.{name}" for name in names if name != "value"]
    else:
        # A node that counts may be where the field has a name.
        noted = ""
        parts = [f"part if type(part := item.{name}) in plain else shape(part, numbers)" for name in names]
    scope: dict[str, Any] = {"kind": kind, "plain": _PLAIN, "shape": _shape}
    exec(f"def shape_of(item, numbers):\n{noted}    return (kind, {', '.join(parts)})", scope)
    return scope["shape_of"]  # type: ignore[no-any-return]


_PLAIN = frozenset({str, int, bool, NoneType})
"""Types of values in which no number counts."""


def numbers_in(item: object) -> list[Any]:
    """The nodes of a tree that may count, in the order of its outline."""
    found: list[Any] = []

    def noted(number: Any, _: object) -> Any:
        found.append(number)
        return number

    refilled(item, noted)
    return found


def refilled(item: T, made: Callable[[Any, object], object], around: object = None) -> T:
    """The same tree with other nodes for its numbers: ``made`` returns one for each, in the order of the outline, from
    it and the node around it.
    """
    found: Any = item
    if isinstance(item, Counted):
        found = made(item, around)
    elif isinstance(item, tuple):
        found = tuple([refilled(part, made, around) for part in item])
    elif is_record(item) and not isinstance(item, Closed):
        found = replaced(item, **{name: refilled(getattr(item, name), made, item) for name in field_names(item)})
    return cast("T", found)


def repeated(
    outlines: Sequence[Outline], start: int, counts: Callable[[Sequence[int]], bool]
) -> tuple[int, int, tuple[int, ...]]:
    """The number of parts from ``start`` on that repeat, how often, and by what their numbers change in each iteration.

    ``counts`` decides whether a loop may change its numbers by these steps.
    """
    for period in range(1, LONGEST + 1):
        times, steps = repetitions_from(outlines, start, period, counts)
        if times >= LEAST:
            return period, times, steps
    return 1, 1, ()


def repetitions_from(
    outlines: Sequence[Outline], start: int, period: int, counts: Callable[[Sequence[int]], bool]
) -> tuple[int, tuple[int, ...]]:
    """How often ``period`` parts repeat from ``start`` on, with every number changed by constant steps."""
    times = 1
    steps: list[int] = []
    while True:
        there = start + times * period
        change: list[int] = []
        for position in range(there, there + period):
            if position >= len(outlines) or outlines[position].shape != outlines[position - period].shape:
                return times, tuple(steps)
            before, after = outlines[position - period].numbers, outlines[position].numbers
            change += [b - a for a, b in zip(before, after, strict=True)]
        if change != steps if times > 1 else not counts(change):
            return times, tuple(steps)
        steps, times = change, times + 1
        if isinstance(outlines, OutlinesOfRows):
            times = max(times, outlines.times(start, period))
