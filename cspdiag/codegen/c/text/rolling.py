"""Finds the loop behind statements that were unrolled: groups that differ only in numbers that count."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import repeat
from typing import Any, TypeVar

from cspdiag.base.record import field_names, is_record, record, replaced
from cspdiag.codegen.c.text.code import PRODUCT, SUM, Atom, Code, Count, cast, code, infix, unsigned
from cspdiag.codegen.c.text.statements import Block, Plain

LEAST = 3
"""Fewer groups than this stay as they are."""

LONGEST = 4
"""So many different groups may make a turn of a loop together."""

T = TypeVar("T")


def rolled(groups: Sequence[Sequence[Plain]], variable: str = "i") -> list[Plain | Block]:
    """The statements of all groups, where at least three that count stand in a row as a loop."""
    parsed = [_Group.of(group) for group in groups]
    result: list[Plain | Block] = []
    start = 0
    while start < len(parsed):
        period, turns, steps = _repeated(parsed, start)
        if turns >= LEAST and any(steps):
            first = [statement for group in groups[start : start + period] for statement in group]
            numbers = [number for group in parsed[start : start + period] for number in group.numbers]
            result.append(_loop(first, numbers, steps, turns, variable))
            start += period * turns
        else:
            result += groups[start]
            start += 1
    return result


@record
class _Group:
    """Statements with their numbers taken out."""

    skeleton: tuple[Plain, ...]
    numbers: tuple[int, ...]

    @staticmethod
    def of(group: Sequence[Plain]) -> _Group:
        numbers = tuple(count.value for count in _counts(tuple(group)))
        return _Group(_with(tuple(group), (replaced(count, value=0) for count in _counts(tuple(group)))), numbers)


def _counts(item: object) -> Iterator[Count]:
    if isinstance(item, Count):
        yield item
    elif isinstance(item, tuple):
        for part in item:
            yield from _counts(part)
    elif is_record(item):
        for name in field_names(item):
            yield from _counts(getattr(item, name))


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


def _repeated(groups: Sequence[_Group], start: int) -> tuple[int, int, tuple[int, ...]]:
    """How many groups from ``start`` come again and again, how often, and by which steps every number in them changes."""
    for period in range(1, LONGEST + 1):
        turns, steps = _run(groups, start, period)
        if turns >= LEAST and any(steps):
            return period, turns, steps
    return 1, 1, ()


def _run(groups: Sequence[_Group], start: int, period: int) -> tuple[int, tuple[int, ...]]:
    first, turns = groups[start : start + period], 1
    steps: tuple[int, ...] | None = None
    while True:
        there = start + turns * period
        following = groups[there : there + period]
        if [group.skeleton for group in following] != [group.skeleton for group in first]:
            return turns, steps or ()
        change = tuple(
            b - a
            for before, after in zip(groups[there - period : there], following, strict=True)
            for a, b in zip(before.numbers, after.numbers, strict=True)
        )
        if steps is not None and change != steps:
            return turns, steps
        steps, turns = change, turns + 1


def _loop(first: Sequence[Plain], numbers: Sequence[int], steps: Sequence[int], count: int, variable: str) -> Block:
    begin = next((number for number, step in zip(numbers, steps, strict=True) if step == 1), 0)
    counts = zip(_counts(tuple(first)), steps, repeat(begin), repeat(variable))
    body = _with(tuple(first), (_value(*item) for item in counts))
    head = f"for (uint32_t {variable} = {begin}U; {variable} < {begin + count}U; {variable}++)"
    return Block(body, head)


def _value(first: Count, step: int, begin: int, variable: str) -> Code:
    """The number that is ``first`` where the variable begins, and changes by ``step``."""
    if step == 0:
        return first
    index: Code = Atom(variable)
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
