"""Rolls repeated code into loops: elements that differ only in consecutive numbers.

``Cell(f"{name}.cell[0]", ...)`` and 999 similar calls become one comprehension. The repetition is found in the trees
that the generator has built, so the loop means the same as its elements by construction.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from itertools import accumulate, groupby
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
from cspdiag.codegen.shared.trees import LEAST, Outline, Stretch, outline, refilled, repeated, stretches

T = TypeVar("T")


def rolled_list(elements: Sequence[Code], variable: str) -> Code:
    """A list of the elements: a comprehension, or single elements and starred comprehensions if only a part of them
    repeats.
    """
    return _list(alike_runs(elements, variable), len(elements), variable)


def rolled_rows(rows: Sequence[Stretch], made: Callable[[int], Code], variable: str) -> Code:
    """The same list of elements that ``made`` makes by their position, which is done for a few only: all that a row
    says of its element is in its shape, except for whole numbers, and the numbers of the element are among those of
    the row.
    """
    outlines: list[Stretch] = []
    start = 0
    for _, group in groupby(rows, key=attrgetter("shape")):
        alike = list(group)
        outlines += _outlines_of(alike, start, made)
        start += sum(row.count for row in alike)
    return _list(_runs(outlines, made, variable), start, variable)


def _outlines_of(rows: Sequence[Stretch], start: int, made: Callable[[int], Code]) -> list[Stretch]:
    """The outlines of elements from ``start`` on with rows of one shape."""
    count = sum(row.count for row in rows)
    first, last = rows[0], rows[-1]
    second = first.numbers_at(1) if first.count > 1 or len(rows) == 1 else rows[1].numbers
    witnesses = {0: first.numbers, 1: second, count - 1: last.numbers_at(last.count - 1)}
    if count > len(witnesses):
        known = [outline(made(start + position)) for position in witnesses]
        columns = _columns([one.numbers for one in known], [*witnesses.values()], rows)
        if columns is not None and len({one.shape for one in known}) == 1:
            return [_with_columns(known[0].shape, row, columns) for row in rows]
    return stretches(outline(made(start + position)) for position in range(count))


def _with_columns(shape: Hashable, row: Stretch, columns: Sequence[int]) -> Stretch:
    numbers, steps = row.numbers, row.steps
    return Stretch(shape, tuple([numbers[at] for at in columns]), tuple([steps[at] for at in columns]), row.count)


def _columns(
    numbers: Sequence[tuple[int, ...]], witnesses: Sequence[tuple[int, ...]], rows: Sequence[Stretch]
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
        if first is None or any(not _are_equal(row, first, other) for other in others for row in rows):
            return None
        found.append(first)
    return found


def _are_equal(row: Stretch, one: int, other: int) -> bool:
    """Whether two numbers of a stretch are equal in all outlines."""
    return row.numbers[one] == row.numbers[other] and row.steps[one] == row.steps[other]


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
    return _runs(stretches(_outlines(elements)), elements.__getitem__, variable)


def _outlines(elements: Iterable[object]) -> list[Outline]:
    """The outlines of elements. Those that follow one another share their shape, which may be as large as they are."""
    found: list[Outline] = []
    for element in elements:
        made = outline(element)
        if found and made.shape == found[-1].shape:
            made = Outline(found[-1].shape, made.numbers)
        found.append(made)
    return found


def _runs(outlines: Sequence[Stretch], made: Callable[[int], T], variable: str) -> Iterator[tuple[int, int, T]]:
    count = sum(stretch.count for stretch in outlines)
    whole = _template(made(0), outlines, variable, 0) if count >= LEAST else None
    if whole is not None:
        yield 0, count, whole
        return
    start = 0
    rest = list(reversed(outlines))
    while rest:
        alike, following = _counting(rest)
        turns = sum(stretch.count for stretch in alike)
        part = _template(made(start), alike, variable, start) if turns >= LEAST else None
        if part is None:
            turns, part, following = 1, made(start), _without_first(rest)
        yield start, turns, part
        start += turns
        rest = following


def _counting(rest: Sequence[Stretch]) -> tuple[list[Stretch], list[Stretch]]:
    """The longest stretch, in parts, from the last of these on, of which each number is the same or counts by one; and
    those that follow it, the first one last.
    """
    first, others = rest[-1], list(rest[:-1])
    if first.count > 1 and not _counts(first.steps):
        return [first.first()], [*others, first.after_first()]
    alike = [first]
    steps = first.steps if first.count > 1 else None
    while others and others[-1].shape == first.shape:
        following, last = others[-1], alike[-1]
        change = _change(last.numbers_at(last.count - 1), following.numbers)
        if change != steps if steps is not None else not _counts(change):
            break
        steps = change
        del others[-1]
        if following.count > 1 and following.steps != steps:
            alike.append(following.first())
            others.append(following.after_first())
            break
        alike.append(following)
    return alike, others


def _without_first(rest: Sequence[Stretch]) -> list[Stretch]:
    *others, first = rest
    return others if first.count == 1 else [*others, first.after_first()]


def _change(before: Sequence[int], after: Sequence[int]) -> tuple[int, ...]:
    return tuple([later - earlier for earlier, later in zip(before, after, strict=True)])


def template(elements: Sequence[T], variable: str, start: int = 0) -> T | None:
    """An expression or statement that equals the elements in turn as ``variable`` counts from ``start``; None if there
    is none.
    """
    return _template(elements[0], stretches(map(outline, elements)), variable, start)


def _template(first: T, outlines: Sequence[Stretch], variable: str, start: int) -> T | None:
    """The same from the ``first`` of the elements and the outlines of all."""
    if any(stretch.shape != outlines[0].shape for stretch in outlines):
        return None
    counted: list[Code | None] = []
    for column in range(len(outlines[0].numbers)):
        values = [(stretch.numbers[column], stretch.steps[column], stretch.count) for stretch in outlines]
        if all(number == values[0][0] and not step for number, step, _ in values):
            counted.append(None)
            continue
        number = _counted(values, variable, start)
        if number is None:
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


def _counted(values: Sequence[tuple[int, int, int]], variable: str, start: int) -> Code | None:
    """An expression with these values, which may wrap around: some of them in sequence each by the first, the step and
    their number.
    """
    offset, size = values[0][0] - start, sum(count for _, _, count in values)
    positions = [*accumulate((count for _, _, count in values), initial=start)]
    places = list(zip(positions, values, strict=False))
    if all(first == place + offset and (count == 1 or step == 1) for place, (first, step, count) in places):
        return _shifted(variable, offset)
    if start == 0 and all(_wraps(place + offset, size, *stretch) for place, stretch in places):
        return infix("%", PRODUCT, _shifted(variable, offset), Constant(str(size)))
    return None


def _wraps(place: int, size: int, first: int, step: int, count: int) -> bool:
    """Whether values that count by a step are the remainders of numbers in sequence from ``place`` on."""
    if count <= 2:
        return all(first + step * position == (place + position) % size for position in range(count))
    return step == 1 and first == place % size and first + count <= size


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
