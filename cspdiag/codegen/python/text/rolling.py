"""Rolls repeated code into loops: elements that differ only in consecutive numbers.

``Cell(f"{name}.cell[0]", ...)`` and 999 similar calls become one comprehension. The repetition is found in the trees
that the generator has built, so the loop means the same as its elements by construction.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from itertools import groupby
from operator import attrgetter
from typing import TypeVar

from cspdiag.codegen.python.text.code import (
    PRIMARY,
    PRODUCT,
    SUM,
    Attribute,
    Chain,
    Code,
    Comprehension,
    Conditional,
    Constant,
    Items,
    Name,
    Prefix,
    Starred,
    WholeNumber,
    at_least,
    counted_from,
    counted_to,
)
from cspdiag.codegen.python.text.operators import infix
from cspdiag.codegen.python.text.statements import Statements, repeat
from cspdiag.codegen.shared.trees import LEAST, Outline, outline, refilled, repeated, repetitions_from

T = TypeVar("T")


def rolled_list(elements: Sequence[Code], variable: str) -> Code:
    """A list of the elements: a comprehension, or single elements and starred comprehensions if only a part of them
    repeats.
    """
    return _list(alike_runs(elements, variable), len(elements), variable)


def rolled_rows(rows: Sequence[Outline], made: Callable[[int], Code], variable: str) -> Code:
    """The same list of elements that ``made`` makes by their position, which is done for a few only: all that a row
    says of its element is in its shape, except for whole numbers, and the numbers of the element are among those of
    the row.
    """
    outlines: list[Outline] = []
    for _, group in groupby(rows, key=attrgetter("shape")):
        outlines += _outlines_of([row.numbers for row in group], len(outlines), made)
    return _list(_runs(outlines, made, variable), len(rows), variable)


def _outlines_of(rows: Sequence[tuple[int, ...]], start: int, made: Callable[[int], Code]) -> list[Outline]:
    """The outlines of elements from ``start`` on with rows of one shape."""
    witnesses = [0, 1, len(rows) - 1]
    if len(rows) > len(witnesses):
        known = [outline(made(start + position)) for position in witnesses]
        columns = _columns([one.numbers for one in known], [rows[position] for position in witnesses], rows)
        if columns is not None and len({one.shape for one in known}) == 1:
            return [Outline(known[0].shape, tuple([row[column] for column in columns])) for row in rows]
    return [outline(made(start + position)) for position in range(len(rows))]


def _columns(
    numbers: Sequence[tuple[int, ...]], witnesses: Sequence[tuple[int, ...]], rows: Sequence[tuple[int, ...]]
) -> list[int] | None:
    """Where the ``numbers`` of elements are in the rows of these; None if that is not certain."""
    if len(set(map(len, numbers))) > 1:
        return None
    places: dict[tuple[int, ...], list[int]] = {}
    for column, values in enumerate(zip(*witnesses, strict=True)):
        places.setdefault(values, []).append(column)
    found: list[int] = []
    for values in zip(*numbers, strict=True):
        first, *others = places.get(values, (None,))
        if first is None or any(row[first] != row[other] for other in others for row in rows):
            return None
        found.append(first)
    return found


def _list(runs: Iterable[tuple[int, int, Code]], count: int, variable: str) -> Code:
    items: list[Code] = []
    for start, turns, part in runs:
        if turns == count >= LEAST:
            return Comprehension(part, variable, counted_to(turns))
        items.append(part if turns == 1 else Starred(Comprehension(part, variable, counted_from(start, turns), "()")))
    return Items("[]", tuple(items))


def alike_runs(elements: Sequence[T], variable: str) -> Iterator[tuple[int, int, T]]:
    """The elements, where those that follow one another and differ only in numbers that count are one, in which
    ``variable`` is the position: the position of the first, their number, and the element that they share.
    """
    return _runs(_outlines(elements), elements.__getitem__, variable)


def _outlines(elements: Iterable[object]) -> list[Outline]:
    """The outlines of elements. Those that follow one another share their shape, which may be as large as they are."""
    found: list[Outline] = []
    for element in elements:
        made = outline(element)
        if found and made.shape == found[-1].shape:
            made = Outline(found[-1].shape, made.numbers)
        found.append(made)
    return found


def _runs(outlines: Sequence[Outline], made: Callable[[int], T], variable: str) -> Iterator[tuple[int, int, T]]:
    whole = _template(made(0), outlines, variable, 0) if len(outlines) >= LEAST else None
    if whole is not None:
        yield 0, len(outlines), whole
        return
    start = 0
    while start < len(outlines):
        turns, _ = repetitions_from(outlines, start, 1, _counts)
        alike = outlines[start : start + turns]
        part = _template(made(start), alike, variable, start) if turns >= LEAST else None
        if part is None:
            turns, part = 1, made(start)
        yield start, turns, part
        start += turns


def template(elements: Sequence[T], variable: str, start: int = 0) -> T | None:
    """An expression or statement that equals the elements in turn as ``variable`` counts from ``start``; None if there
    is none.
    """
    return _template(elements[0], map(outline, elements), variable, start)


def _template(first: T, outlines: Iterable[Outline], variable: str, start: int) -> T | None:
    """The same from the ``first`` of the elements and the outlines of all."""
    rows: list[tuple[int, ...]] = []
    shape: Hashable = None
    for element in outlines:
        if not rows:
            shape = element.shape
        elif element.shape != shape:
            return None
        rows.append(element.numbers)
    counted: list[Code | None] = []
    for values in zip(*rows, strict=True):
        number = None if len(set(values)) == 1 else _counted(values, variable, start)
        if number is None and len(set(values)) > 1:
            return None
        counted.append(number)
    return _refilled(first, counted)


def rolled_steps(
    groups: Sequence[Statements],
    index_around: Callable[[Sequence[Statements]], str],
    is_worth_it: Callable[[Statements], bool] = lambda _: True,
) -> Statements:
    """Consecutive groups of statements; at least three that are equal except for an index become a loop, if the first
    of them ``is_worth_it``. Loops that repeat are a loop, too; ``index_around`` names the variable of each.
    """
    rolled, count = [*groups], len(groups) + 1
    while len(rolled) < count:
        count, rolled = len(rolled), _rolled_once(rolled, index_around(rolled), is_worth_it)
    return tuple(statement for group in rolled for statement in group)


def _rolled_once(
    groups: Sequence[Statements], variable: str, is_worth_it: Callable[[Statements], bool]
) -> list[Statements]:
    outlines = [outline(group) for group in groups]
    result: list[Statements] = []
    start = 0
    while start < len(groups):
        period, turns, steps = repeated(outlines, start, _counts)
        first = tuple(statement for group in groups[start : start + period] for statement in group)
        if turns < LEAST or (first and not is_worth_it(first)):
            result.append(groups[start])
            start += 1
            continue
        numbers = [number for part in outlines[start : start + period] for number in part.numbers]
        body = _refilled(first, [_shifted(variable, n) if s else None for n, s in zip(numbers, steps, strict=True)])
        result.append((repeat(turns, body, variable if any(steps) else "_"),) if first else ())
        start += period * turns
    return result


def _counts(steps: Sequence[int]) -> bool:
    return all(step in (0, 1) for step in steps)


def _counted(values: Sequence[int], variable: str, start: int) -> Code | None:
    """An expression with these values, which may wrap around."""
    offset, size = values[0] - start, len(values)
    if all(value == start + position + offset for position, value in enumerate(values)):
        return _shifted(variable, offset)
    if start == 0 and all(value == (position + offset) % size for position, value in enumerate(values)):
        return infix("%", PRODUCT, _shifted(variable, offset), Constant(str(size)))
    return None


def _shifted(variable: str, offset: int) -> Code:
    if offset == 0:
        return Name(variable)
    return infix("+" if offset > 0 else "-", SUM, Name(variable), Constant(str(abs(offset))))


def _refilled(item: T, counted: Sequence[Code | None]) -> T:
    """The tree with the counted expressions in place of its numbers; a sum next to an operator gets parentheses."""
    codes = iter(counted)

    def made(number: WholeNumber, around: object) -> Code:
        code = next(codes)
        if code is None:
            return number
        return at_least(code, PRIMARY) if isinstance(around, Chain | Conditional | Prefix | Attribute) else code

    return refilled(item, made)
