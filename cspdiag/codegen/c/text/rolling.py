"""Finds the loop behind statements that were unrolled: groups that differ only in numbers that count."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Sequence
from typing import Any, TypeVar

from cspdiag.base.record import field_names, is_record, record, replaced
from cspdiag.codegen.c.text.code import PRODUCT, SUM, Atom, Code, Count, cast, code, infix, unsigned
from cspdiag.codegen.c.text.statements import Block, Plain

LEAST = 3
"""Fewer groups than this stay as they are."""

LONGEST = 4
"""So many different groups may make a turn of a loop together."""

VARIABLE = "i"
"""What counts."""

T = TypeVar("T")


@record
class Outline:
    """What decides how statements read, without the statements: those of one ``shape`` differ in ``numbers`` only."""

    shape: Hashable
    numbers: tuple[int, ...]


def rolled(groups: Sequence[Sequence[Plain]]) -> list[Plain | Block]:
    """The statements of all groups, where at least three that count stand in a row as a loop."""
    return rolled_from([_outline(group) for group in groups], lambda position: groups[position])


def rolled_from(outlines: Sequence[Outline], make: Callable[[int], Sequence[Plain]]) -> list[Plain | Block]:
    """The same where ``make`` gives the statements of the group at a position: of a loop no more than two turns are
    made.
    """
    result: list[Plain | Block] = []
    start = 0
    while start < len(outlines):
        period, turns = _repeated(outlines, start)
        if turns >= LEAST:
            first, second = (
                tuple(statement for position in range(begin, begin + period) for statement in make(position))
                for begin in (start, start + period)
            )
            result += [_loop(first, second, turns)] if first else []
            start += period * turns
        else:
            result += make(start)
            start += 1
    return result


def _outline(group: Sequence[Plain]) -> Outline:
    counts: list[Count] = []
    shape = _shape(tuple(group), counts)
    return Outline(shape, tuple(count.value for count in counts))


def _shape(item: object, counts: list[Count]) -> Hashable:
    """What two trees have in common that differ in nothing but their numbers, which are added to ``counts`` in their
    order.
    """
    if isinstance(item, str):
        return item
    if isinstance(item, Count):
        counts.append(item)
        return item.form
    if isinstance(item, tuple):
        return tuple([_shape(part, counts) for part in item])
    if is_record(item):
        return (type(item), *[_shape(getattr(item, name), counts) for name in field_names(item)])
    assert isinstance(item, Hashable)
    return item


def _with(item: T, codes: Iterator[Code]) -> T:
    """The same tree with other nodes for its numbers, in their order."""
    found: Any = item
    if isinstance(item, Count):
        found = next(codes)
    elif isinstance(item, tuple):
        found = tuple(_with(part, codes) for part in item)
    elif is_record(item):
        found = replaced(item, **{name: _with(getattr(item, name), codes) for name in field_names(item)})
    return found  # type: ignore[no-any-return]


def _repeated(outlines: Sequence[Outline], start: int) -> tuple[int, int]:
    """How many groups from ``start`` come again and again, and how often."""
    for period in range(1, LONGEST + 1):
        turns = _turns(outlines, start, period)
        if turns >= LEAST:
            return period, turns
    return 1, 1


def _turns(outlines: Sequence[Outline], start: int, period: int) -> int:
    """How often ``period`` groups come from ``start``, every number changed by the same steps, not all of them by
    nothing.
    """
    turns = 1
    steps: list[int] = []
    while True:
        there = start + turns * period
        change: list[int] = []
        for position in range(there, there + period):
            if position >= len(outlines) or outlines[position].shape != outlines[position - period].shape:
                return turns
            before, after = outlines[position - period].numbers, outlines[position].numbers
            change += [b - a for a, b in zip(before, after, strict=True)]
        if (turns > 1 and change != steps) or not any(change):
            return turns
        steps, turns = change, turns + 1


def _loop(first: tuple[Plain, ...], second: tuple[Plain, ...], turns: int) -> Block:
    numbers: list[Count] = []
    following: list[Count] = []
    _shape(first, numbers)
    _shape(second, following)
    steps = [after.value - before.value for before, after in zip(numbers, following, strict=True)]
    begin = next((number.value for number, step in zip(numbers, steps, strict=True) if step == 1), 0)
    values = (_value(number, step, begin) for number, step in zip(numbers, steps, strict=True))
    head = f"for (uint32_t {VARIABLE} = {begin}U; {VARIABLE} < {begin + turns}U; {VARIABLE}++)"
    return Block(_with(first, values), head)


def _value(first: Count, step: int, begin: int) -> Code:
    """The number that is ``first`` where the variable begins, and changes by ``step``."""
    if step == 0:
        return first
    index: Code = Atom(VARIABLE)
    if step == 1:
        offset = first.value - begin
        value = index if offset == 0 else infix("+" if offset > 0 else "-", SUM, index, unsigned(abs(offset)))
    else:
        counted = index if begin == 0 else infix("-", SUM, index, unsigned(begin))
        product = counted if abs(step) == 1 else infix("*", PRODUCT, unsigned(abs(step)), counted)
        value = (
            product
            if step > 0 and first.value == 0
            else infix("+" if step > 0 else "-", SUM, unsigned(first.value), product)
        )
    return cast("int64_t", value) if first.form == "argument" else value


def marked(value: int) -> Code:
    """A whole number as an argument that may count."""
    return code(Count(value, "argument"))
