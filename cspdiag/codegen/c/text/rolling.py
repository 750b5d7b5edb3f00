"""Rolls repeated statements into loops: groups of statements that differ only in numbers that count up or down."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

from cspdiag.codegen.c.text.code import PRODUCT, SUM, Atom, Code, Count, cast, code, infix, unsigned
from cspdiag.codegen.c.text.statements import Block, For, Plain, Statement
from cspdiag.codegen.shared.trees import LEAST, Outline, numbers_in, outline, refilled, repeated

VARIABLE = "i"
"""The loop variable."""

Rolled: TypeAlias = Plain | Block | For
"""Statements that may be replaced by a loop, and the loop."""


def rolled(groups: Sequence[Sequence[Plain]]) -> list[Rolled]:
    """The statements of all groups, with each run of at least three that count as a loop."""
    return rolled_from([outline(tuple(group)) for group in groups], lambda position: groups[position])


def rolled_from(outlines: Sequence[Outline], make: Callable[[int], Sequence[Rolled]]) -> list[Rolled]:
    """The same, with a function ``make`` from the position of a group to its statements: for a loop it is called for
    the first two groups only.
    """
    result: list[Rolled] = []
    start = 0
    while start < len(outlines):
        period, iterations, _ = repeated(outlines, start, any)
        if iterations >= LEAST:
            first, second = (
                tuple(statement for position in range(begin, begin + period) for statement in make(position))
                for begin in (start, start + period)
            )
            result += [loop(first, second, iterations)] if first else []
            start += period * iterations
        else:
            result += make(start)
            start += 1
    return result


def loop(first: tuple[Statement, ...], second: tuple[Statement, ...], iterations: int) -> For:
    """The loop whose first iterations are ``first`` and ``second``."""
    numbers: list[Count] = numbers_in(first)
    steps = [after - before.value for before, after in zip(numbers, outline(second).numbers, strict=True)]
    begin = next((number.value for number, step in zip(numbers, steps, strict=True) if step == 1), 0)
    values = (_value(number, step, begin) for number, step in zip(numbers, steps, strict=True))
    body = refilled(first, lambda _, __: next(values))
    return For(Atom(VARIABLE), unsigned(begin + iterations), body, begin=unsigned(begin), type_name="uint32_t")


def _value(first: Count, step: int, begin: int) -> Code:
    """The number that is ``first`` in the first iteration, and changes by ``step`` in each."""
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


def countable(value: int) -> Code:
    """An integer argument that may count in a loop; it is not negative, as columns of tables and sums expect."""
    return code(Count(value, "argument"))
