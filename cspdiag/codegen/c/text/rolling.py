"""Finds the loop behind statements that were unrolled: groups that differ only in numbers that count."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

from cspdiag.codegen.c.text.code import PRODUCT, SUM, Atom, Code, Count, cast, code, infix, unsigned
from cspdiag.codegen.c.text.statements import Block, For, Plain
from cspdiag.codegen.shared.trees import LEAST, Outline, numbers_in, outline, refilled, repeated

VARIABLE = "i"
"""What counts."""

Rolled: TypeAlias = Plain | Block | For
"""What a loop may replace, and the loop."""


def rolled(groups: Sequence[Sequence[Plain]]) -> list[Rolled]:
    """The statements of all groups, where at least three that count stand in a row as a loop."""
    return rolled_from([outline(tuple(group)) for group in groups], lambda position: groups[position])


def rolled_from(outlines: Sequence[Outline], make: Callable[[int], Sequence[Rolled]]) -> list[Rolled]:
    """The same where ``make`` gives the statements of the group at a position: of a loop no more than two turns are
    made.
    """
    result: list[Rolled] = []
    start = 0
    while start < len(outlines):
        period, turns, _ = repeated(outlines, start, any)
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


def _loop(first: tuple[Rolled, ...], second: tuple[Rolled, ...], turns: int) -> For:
    numbers: list[Count] = numbers_in(first)
    steps = [after - before.value for before, after in zip(numbers, outline(second).numbers, strict=True)]
    begin = next((number.value for number, step in zip(numbers, steps, strict=True) if step == 1), 0)
    values = (_value(number, step, begin) for number, step in zip(numbers, steps, strict=True))
    body = refilled(first, lambda _, __: next(values))
    return For(Atom(VARIABLE), unsigned(begin + turns), body, begin=unsigned(begin), type_name="uint32_t")


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
