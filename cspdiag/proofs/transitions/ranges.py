"""Ranges of whole numbers that are not distinguished from each other.

The numbers that a variable or a channel may have are cut into **cells** wherever a condition of the program begins or
ceases to hold: a condition holds for all numbers of a cell or for none. The arithmetic is that of intervals (Moore,
"Interval Analysis"; Cousot and Cousot 1976).
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
    """One of at least two whole numbers, from ``low`` to ``high`` inclusive; ``copied`` if it is a number that the
    environment gave and the program passed on unchanged.
    """

    low: int
    high: int
    copied: bool = False


Cell: TypeAlias = "int | Range"
"""A number, or several consecutive ones."""

MOST_CELLS = 40
"""Numbers with more cells are not distinguished at all."""


def cell(low: int, high: int) -> Cell:
    """The numbers from ``low`` to ``high``, where ``low <= high``."""
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
    """All numbers of a type, cut before each of the boundaries; empty if its numbers are not distinguished: there is no
    boundary, or there are too many.
    """
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
    """The cells with one number split off from each range, as a representative: a process that only passes numbers on
    treats every number of the range as it treats this one.

    All numbers of the type are one range if ``among`` is empty. (Wolper, "Expressing interesting properties of programs
    in propositional temporal logic", 1986.)
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
    """The parts of ``value`` that lie in the cells, one for each cell that it overlaps."""
    low, high = bounds(value)
    return tuple(
        cell(max(low, first), min(high, last)) for first, last in map(bounds, among) if first <= high and low <= last
    )


def cell_of(value: Cell, among: Sequence[Cell]) -> Cell | None:
    """The cell that contains all of ``value``; None if no single cell does."""
    low, high = bounds(value)
    position = bisect_right(among, low, key=lambda entry: bounds(entry)[0]) - 1
    if position < 0 or high > bounds(among[position])[1]:
        return None
    return among[position]


def compared(operator: str, left: Cell, right: Cell) -> bool | None:
    """Whether a comparison holds; None if it holds for some of the numbers only."""
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
    """The results of an operation that lie within the type; None if there are none or they are not known."""
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
    """A range as transition systems print it: ``0..499``; ``3..`` and ``..1`` where it reaches the end of the type."""
    least, most = limits_of(kind) or bounds(value)
    low = "" if value.low == least else value_text(value.low, kind)
    high = "" if value.high == most else value_text(value.high, kind)
    return f"{low}..{high}"
