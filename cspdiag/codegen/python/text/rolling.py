"""Rolls repeated code into loops: elements that differ only in consecutive numbers.

``Cell(f"{name}.cell[0]", ...)`` and 999 similar calls become one comprehension. The repetition is found in the trees
that the generator has built, so the loop means the same as its elements by construction.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Sequence
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
    infix,
)
from cspdiag.codegen.python.text.statements import Statement, Statements, repeat
from cspdiag.codegen.shared.trees import LEAST, Outline, outline, refilled, repeated, repetitions_from

T = TypeVar("T")


def rolled_list(elements: Sequence[Code], variable: str) -> Code:
    """A list of the elements: a comprehension, or single elements and starred comprehensions if only a part of them
    repeats.
    """
    items: list[Code] = []
    for start, turns, part in alike_runs(elements, variable):
        if turns == len(elements) >= LEAST:
            return Comprehension(part, variable, counted_to(turns))
        items.append(part if turns == 1 else Starred(Comprehension(part, variable, counted_from(start, turns), "()")))
    return Items("[]", tuple(items))


def alike_runs(elements: Sequence[T], variable: str) -> Iterator[tuple[int, int, T]]:
    """The elements, where those that follow one another and differ only in numbers that count are one, in which
    ``variable`` is the position: the position of the first, their number, and the element that they share.
    """
    outlines = [outline(element) for element in elements]
    whole = _template(elements[0], outlines, variable, 0) if len(elements) >= LEAST else None
    if whole is not None:
        yield 0, len(elements), whole
        return
    start = 0
    while start < len(elements):
        turns, _ = repetitions_from(outlines, start, 1, _counts)
        alike = outlines[start : start + turns]
        part = _template(elements[start], alike, variable, start) if turns >= LEAST else None
        if part is None:
            turns, part = 1, elements[start]
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


def rolled_steps(groups: Sequence[Statements], variable: str) -> Statements:
    """Consecutive groups of statements; at least three that are equal except for an index become a loop."""
    outlines = [outline(group) for group in groups]
    result: list[Statement] = []
    start = 0
    while start < len(groups):
        period, turns, steps = repeated(outlines, start, _counts)
        if turns >= LEAST:
            first = tuple(statement for group in groups[start : start + period] for statement in group)
            numbers = [number for part in outlines[start : start + period] for number in part.numbers]
            body = _refilled(first, [_shifted(variable, n) if s else None for n, s in zip(numbers, steps, strict=True)])
            result += [repeat(turns, body, variable if any(steps) else "_")] if first else []
            start += period * turns
        else:
            result += groups[start]
            start += 1
    return tuple(result)


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
