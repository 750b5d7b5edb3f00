"""Trees of generated code: traversal, and repetition in parts that differ only in numbers."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Sequence
from functools import cache
from types import NoneType
from typing import Any, TypeVar

from cspdiag.base.record import ATOMS, annotations_of, field_names, is_record, record, replaced

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
    return found  # type: ignore[no-any-return]


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
