"""Traces and when they are equal (language, "Scheduling and traces"), for all implementations of the language."""

from __future__ import annotations

import dataclasses
from collections.abc import Collection, Iterable, Sequence
from typing import Any, NamedTuple


class Communication(NamedTuple):
    """A value that passed through an external port or a channel at ``time`` (nanoseconds)."""

    time: int
    channel: str
    value: object


class Ending(NamedTuple):
    """How a run ended (``terminated``, ``deadlock``, ``time limit``, ``failed``), when, and the exception's name."""

    ended: str
    time: int
    error: str | None = None


class Execution(NamedTuple):
    """What an implementation did with a program."""

    trace: Sequence[Communication]
    ending: Ending


@dataclasses.dataclass
class Difference:
    """The first communication of ``channel`` (``external ports`` for all of them together) on which two traces differ."""

    channel: str
    position: int
    left: Sequence[Communication]
    right: Sequence[Communication]

    def __str__(self) -> str:
        first = max(0, self.position - 3)
        lines = [f"{self.channel}: communication {self.position} differs"]
        for name, side in (("left", self.left), ("right", self.right)):
            lines.append(f"  {name}:")
            for number in range(first, min(len(side), self.position + 3)):
                time, channel, value = side[number]
                mark = ">" if number == self.position else " "
                lines.append(f"  {mark} {number}: {time / 1e6:.6f} ms {channel} {value!r}")
            if len(side) <= self.position:
                lines.append("  > end")
        return "\n".join(lines)


def plain(value: Any) -> object:
    """A value as traces compare it: to the bit, true apart from 1, structs and arrays as tuples."""
    if isinstance(value, bool):
        return value
    if isinstance(value, float):
        return value.hex()
    if isinstance(value, int):
        return int(value)
    return tuple(plain(part) for part in value)


def compare(
    left: Iterable[Communication], right: Iterable[Communication], external: Collection[str] = ()
) -> Difference | None:
    """The earliest difference of two traces; None when they are equal.

    Each channel has to have the same times and values, and the ``external`` ports have to have them in the same order.
    """
    first, second = list(left), list(right)
    differences = []
    names = dict.fromkeys(communication.channel for communication in (*first, *second))
    for name in names:
        differences.append(
            _first_difference(name, *([c for c in side if c.channel == name] for side in (first, second)))
        )
    differences.append(
        _first_difference("external ports", *([c for c in side if c.channel in external] for side in (first, second)))
    )
    found = [difference for difference in differences if difference is not None]
    return min(found, key=_time, default=None)


def _first_difference(name: str, left: Sequence[Communication], right: Sequence[Communication]) -> Difference | None:
    for position in range(max(len(left), len(right))):
        if position >= len(left) or position >= len(right) or _key(left[position]) != _key(right[position]):
            return Difference(name, position, left, right)
    return None


def _key(communication: Communication) -> tuple[int, str, object]:
    return communication.time, communication.channel, plain(communication.value)


def _time(difference: Difference) -> int:
    return min(
        side[difference.position].time
        for side in (difference.left, difference.right)
        if difference.position < len(side)
    )
