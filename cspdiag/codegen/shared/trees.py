"""Trees of generated code: looking through them, and finding the loop behind parts that differ in numbers only."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Sequence
from functools import cache
from typing import Any, TypeVar

from cspdiag.base.record import field_names, is_record, record, replaced

T = TypeVar("T")

LEAST = 3
"""Fewer parts than this stay as they are."""

LONGEST = 4
"""The number of different parts that may make one iteration of a loop together."""


class Counted:
    """A number that may count: nodes that differ in their ``value`` only are alike."""

    value: int


class Closed:
    """A node in which nothing counts, as it counts or names something itself: only the same node is like it."""


@record
class Outline:
    """What decides how a tree reads, without the tree: those of one ``shape`` differ in ``numbers`` only."""

    shape: Hashable
    numbers: tuple[int, ...]


def nodes(item: object) -> Iterator[object]:
    """All nodes of a tree, of expressions and of statements."""
    pending = [item]
    while pending:
        part = pending.pop()
        if isinstance(part, tuple | list):
            pending += reversed(part)
        elif is_record(part):
            yield part
            pending += [getattr(part, name) for name in reversed(field_names(part))]


def outline(item: object) -> Outline:
    """The outline of a tree, or of several in a tuple."""
    numbers: list[int] = []
    shape = _shape(item, numbers)
    return Outline(shape, tuple(numbers))


def _shape(item: object, numbers: list[int]) -> Hashable:
    if isinstance(item, tuple):
        return tuple([_shape(part, numbers) for part in item])
    kind: type = type(item)
    names = _shaped_fields(kind)
    if not names:
        return item
    if isinstance(item, Counted):
        numbers.append(item.value)
        return (kind, *[getattr(item, name) for name in names if name != "value"])
    return (kind, *[_shape(getattr(item, name), numbers) for name in names])


def numbers_as_in(first: object, other: object) -> list[int] | None:
    """The numbers of a tree that differs from ``first`` in numbers only; None if it differs in more."""
    numbers: list[int] = []
    return numbers if _is_like(first, other, numbers) else None


def _is_like(first: object, other: object, numbers: list[int]) -> bool:
    if isinstance(first, tuple):
        if not isinstance(other, tuple) or len(first) != len(other):
            return False
        return all(_is_like(a, b, numbers) for a, b in zip(first, other, strict=True))
    kind: type = type(first)
    names = _shaped_fields(kind)
    if not names or kind is not type(other):
        return first == other
    if isinstance(other, Counted):
        numbers.append(other.value)
        names = tuple([name for name in names if name != "value"])
    for name in names:
        a, b = getattr(first, name), getattr(other, name)
        if not _is_like(a, b, numbers):
            return False
    return True


@cache
def _shaped_fields(kind: type) -> tuple[str, ...]:
    """The fields of a node that are looked into; of everything else none."""
    return getattr(kind, "__record_fields__", ()) if not issubclass(kind, Closed) else ()


def numbers_in(item: object) -> list[Any]:
    """The nodes of a tree that may count, in the order of its outline."""
    found: list[Any] = []

    def noted(number: Any, _: object) -> Any:
        found.append(number)
        return number

    refilled(item, noted)
    return found


def refilled(item: T, made: Callable[[Any, object], object], around: object = None) -> T:
    """The same tree with other nodes for its numbers: what ``made`` gives for each, in the order of the outline, and
    for the node that it stands in.
    """
    found: Any = item
    if isinstance(item, Counted):
        found = made(item, around)
    elif isinstance(item, tuple):
        found = tuple([refilled(part, made, around) for part in item])
    elif is_record(item) and not isinstance(item, Closed):
        found = replaced(item, **{name: refilled(getattr(item, name), made, item) for name in field_names(item)})
    return found  # type: ignore[no-any-return]


def repeated(
    outlines: Sequence[Outline], start: int, counts: Callable[[Sequence[int]], bool]
) -> tuple[int, int, tuple[int, ...]]:
    """How many parts from ``start`` come again and again, how often, and by what their numbers change in each turn.

    ``counts`` says whether a loop may change its numbers by these steps.
    """
    for period in range(1, LONGEST + 1):
        turns, steps = turns_from(outlines, start, period, counts)
        if turns >= LEAST:
            return period, turns, steps
    return 1, 1, ()


def turns_from(
    outlines: Sequence[Outline], start: int, period: int, counts: Callable[[Sequence[int]], bool]
) -> tuple[int, tuple[int, ...]]:
    """How often ``period`` parts come from ``start``, every number changed by the same steps."""
    turns = 1
    steps: list[int] = []
    while True:
        there = start + turns * period
        change: list[int] = []
        for position in range(there, there + period):
            if position >= len(outlines) or outlines[position].shape != outlines[position - period].shape:
                return turns, tuple(steps)
            before, after = outlines[position - period].numbers, outlines[position].numbers
            change += [b - a for a, b in zip(before, after, strict=True)]
        if (turns > 1 and change != steps) or not counts(change):
            return turns, tuple(steps)
        steps, turns = change, turns + 1
