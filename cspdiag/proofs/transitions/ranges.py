"""Whole numbers that are not distinguished: a range of them stands for each.

The numbers that a variable or a channel may have are cut into **cells** where the conditions of the program begin to
hold or cease to, so that a condition on it holds for all numbers of a cell or for none. The arithmetic is that of
intervals (Moore, "Interval Analysis"; Cousot and Cousot 1976).
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Sequence
from typing import TypeAlias, assert_never

from cspdiag.base.record import record
from cspdiag.model.types import (
    ArrayType,
    BoolType,
    EnumType,
    IntType,
    RealType,
    StructType,
    TextType,
    TimeType,
    Type,
    UnknownType,
)
from cspdiag.network.dump.expression import value_text


@record(order=True)
class Range:
    """One of at least two whole numbers, from ``low`` to ``high``, both among them; ``copied`` if it is what the
    environment gave, handed on.
    """

    low: int
    high: int
    copied: bool = False


Cell: TypeAlias = "int | Range"
"""A number, or several that follow each other."""

MOST_CELLS = 40
"""Numbers with more cells are not distinguished at all."""


def cell(low: int, high: int) -> Cell:
    """The numbers from ``low`` to ``high``, which is not less."""
    return low if low == high else Range(low, high)


def bounds(value: Cell) -> tuple[int, int]:
    """The smallest and the greatest number."""
    return (value.low, value.high) if isinstance(value, Range) else (value, value)


def limits_of(kind: Type | None) -> tuple[int, int] | None:
    """The smallest and the greatest number of a type of whole numbers; None for other types."""
    match kind:
        case IntType(minimum=minimum, maximum=maximum):
            return minimum, maximum
        case TimeType():
            return IntType().minimum, IntType().maximum
        case (
            BoolType() | RealType() | TextType() | EnumType() | StructType() | ArrayType() | UnknownType() | None
        ):  # fmt: skip
            return None
        case _:
            assert_never(kind)


def cells(kind: Type | None, boundaries: Iterable[int]) -> tuple[Cell, ...]:
    """All numbers of a type, cut before each of the boundaries; nothing where they are not to be distinguished."""
    limits = limits_of(kind)
    if limits is None:
        return ()
    low, high = limits
    starts = [low, *sorted({boundary for boundary in boundaries if low < boundary <= high})]
    if not 1 < len(starts) <= MOST_CELLS:
        return ()
    ends = [*(start - 1 for start in starts[1:]), high]
    return tuple(map(cell, starts, ends))


def with_examples(among: Sequence[Cell], kind: Type | None) -> tuple[Cell, ...]:
    """Of each range one number apart from the others of it, which stands for each: what hands all on alike does with
    any what it does with this one.

    All numbers of the type are one range if there is nothing ``among`` them. (Wolper, "Expressing interesting
    properties of programs in propositional temporal logic", 1986.)
    """
    limits = limits_of(kind)
    if limits is None:
        return tuple(among)
    found: list[Cell] = []
    for entry in among or (cell(*limits),):
        low, high = bounds(entry)
        if low == high:
            found.append(entry)
        elif low != limits[0]:
            found += [low, cell(low + 1, high)]
        elif high != limits[1]:
            found += [cell(low, high - 1), high]
        else:
            middle = 0 if low < 0 else low
            found += [cell(low, middle - 1)] * (low < middle) + [middle, cell(middle + 1, high)]
    return tuple(found)


def pieces(value: Cell, among: Sequence[Cell]) -> tuple[Cell, ...]:
    """What of ``value`` lies in each of the cells."""
    low, high = bounds(value)
    return tuple(
        cell(max(low, first), min(high, last)) for first, last in map(bounds, among) if first <= high and low <= last
    )


def cell_of(value: Cell, among: Sequence[Cell]) -> Cell | None:
    """The cell in which all of ``value`` lies, if it is one."""
    low, high = bounds(value)
    position = bisect_right(among, low, key=lambda entry: bounds(entry)[0]) - 1
    if position < 0 or high > bounds(among[position])[1]:
        return None
    return among[position]


def compared(operator: str, left: Cell, right: Cell) -> bool | None:
    """Whether a comparison holds; None if it holds for some of the numbers."""
    (low, high), (least, most) = bounds(left), bounds(right)
    match operator:
        case "<":
            return True if high < least else False if low >= most else None
        case "<=":
            return True if high <= least else False if low > most else None
        case ">":
            return compared("<", right, left)
        case ">=":
            return compared("<=", right, left)
        case "==" | "!=":
            separate = high < least or most < low
            alike = True if low == high == least == most else False if separate else None
            return alike if operator == "==" or alike is None else not alike
        case _:
            raise AssertionError(f"`{operator}` is no comparison")


def computed(operator: str, left: Cell, right: Cell, kind: Type) -> Cell | None:
    """The numbers that an operation can give, without those that leave the type; None where that is not known."""
    limits = limits_of(kind)
    (low, high), (least, most) = bounds(left), bounds(right)
    match operator:
        case "+":
            low, high = low + least, high + most
        case "-":
            low, high = low - most, high - least
        case "*":
            corners = [low * least, low * most, high * least, high * most]
            low, high = min(corners), max(corners)
        case _:  # The ranges of other operations are not followed.
            return None
    if limits is None:
        return None
    low, high = max(low, limits[0]), min(high, limits[1])
    return cell(low, high) if low <= high else None


def text(value: Range, kind: Type) -> str:
    """As transition systems write it: ``0..499``, ``3..`` and ``..1`` where it goes to the end of the type."""
    least, most = limits_of(kind) or bounds(value)
    low = "" if value.low == least else value_text(value.low, kind)
    high = "" if value.high == most else value_text(value.high, kind)
    return f"{low}..{high}"
