"""Traces, and when they are equal (language reference, "Scheduling and traces"), for all implementations of the
language.
"""

from __future__ import annotations

import dataclasses
import math
import struct
from collections.abc import Collection, Iterable, Sequence
from typing import Any

from cspdiag.semantics.trace import Communication


@dataclasses.dataclass
class Difference:
    """The first communication of ``channel`` (``external ports`` for all of them together) that differs between two
    traces.
    """

    channel: str
    position: int
    left: Sequence[Communication]
    right: Sequence[Communication]

    @property
    def time(self) -> int:
        """The instant of the earlier of the two."""
        return min(side[self.position].time for side in (self.left, self.right) if self.position < len(side))

    def __str__(self) -> str:
        first = max(0, self.position - 3)
        lines = [f"{self.channel}: communication {self.position} differs"]
        for name, side in (("left", self.left), ("right", self.right)):
            lines.append(f"  {name}:")
            for number in range(first, min(len(side), self.position + 3)):
                mark = ">" if number == self.position else " "
                lines.append(f"  {mark} {number}: {shown(side[number])}")
            if len(side) <= self.position:
                lines.append("  > end")
        return "\n".join(lines)


def shown(communication: Communication) -> str:
    """On one line: when, where, what, from whom to whom."""
    time, channel, value, writer, reader = communication
    parties = f"  ({writer or 'environment'} to {reader or 'environment'})" if writer or reader else ""
    return f"{time / 1e6:.6f} ms {channel} {value!r}{parties}"


def plain(value: Any) -> object:
    """A value as traces compare it: to the bit, true distinct from 1, structs and arrays as tuples."""
    if isinstance(value, bool):
        return value
    if isinstance(value, float):
        return value.hex()
    if isinstance(value, int):
        return int(value)
    return tuple(plain(part) for part in value)


def units_apart(left: float, right: float) -> int:
    """The number of doubles from one to the other: the distance in units in the last place; zeros of both signs are
    equal.
    """
    if math.isnan(left) or math.isnan(right):
        return 0 if math.isnan(left) and math.isnan(right) else 2**64
    return abs(_rank(left) - _rank(right))


def _rank(x: float) -> int:
    """A whole number for each double, in the same order."""
    bits: int = struct.unpack("<q", struct.pack("<d", x))[0]
    return bits if bits >= 0 else -(bits & 0x7FFF_FFFF_FFFF_FFFF)


def equal(left: Any, right: Any, units: int) -> bool:
    """Whether two values are equal, doubles within this number of units in the last place."""
    if plain(left) == plain(right):
        return True
    if isinstance(left, float) and isinstance(right, float):
        return units > 0 and units_apart(left, right) <= units
    if isinstance(left, int | float) or isinstance(right, int | float):
        return False
    return len(left) == len(right) and all(equal(a, b, units) for a, b in zip(left, right, strict=True))


def compare(
    left: Iterable[Communication], right: Iterable[Communication], external: Collection[str] = (), units: int = 0
) -> Difference | None:
    """The earliest difference of two traces; None if they are equal.

    Each channel must have the same times and values (doubles within ``units`` in the last place), and the ``external``
    ports must have them in the same order.
    """
    first, second = list(left), list(right)
    differences = []
    names = dict.fromkeys(communication.channel for communication in (*first, *second))
    for name in names:
        sides = [[c for c in side if c.channel == name] for side in (first, second)]
        differences.append(_first_difference(name, sides[0], sides[1], units))
    sides = [[c for c in side if c.channel in external] for side in (first, second)]
    differences.append(_first_difference("external ports", sides[0], sides[1], units))
    found = [difference for difference in differences if difference is not None]
    return min(found, key=lambda difference: difference.time, default=None)


def _first_difference(
    name: str, left: Sequence[Communication], right: Sequence[Communication], units: int
) -> Difference | None:
    for position in range(max(len(left), len(right))):
        if position >= len(left) or position >= len(right) or not _same(left[position], right[position], units):
            return Difference(name, position, left, right)
    return None


def _same(left: Communication, right: Communication, units: int) -> bool:
    return left[:2] == right[:2] and equal(left.value, right.value, units)
