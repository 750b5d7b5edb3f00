"""The places of a composition, and which of them may run at the same time."""

from __future__ import annotations

from dataclasses import dataclass

from tests.oracle.programs.tree import Comp, Guarded, Interrupt, Par, Read, Write, parts

Path = tuple[
    tuple[int, int], ...
]  # the parts around a place, from the outermost: their numbers, and which part of each


@dataclass(frozen=True)
class Place:
    number: int  # in the order of the text
    part: Comp
    path: Path


def places(body: Comp) -> list[Place]:
    """Every part of a composition."""
    found: list[Place] = []

    def look(part: Comp, path: Path) -> None:
        number = len(found)
        found.append(Place(number, part, path))
        for index, inner in enumerate(parts(part)):
            look(inner, (*path, (number, index)))

    look(body, ())
    return found


def beside(one: Place, other: Place, found: list[Place]) -> bool:
    """Whether two places may run at the same time: in parallel branches, or in the body and the guard of an
    interrupt.
    """
    for (a, left), (b, right) in zip(one.path, other.path, strict=False):
        if a != b:
            return False
        if left != right:
            around = found[a].part
            guard = one if left == 1 else other
            return isinstance(around, Par) or (isinstance(around, Interrupt) and guard.path[-1][0] == a)
    return False


def ends(part: Comp) -> tuple[str, str] | None:
    """The channel or port that a place itself uses, and `?` or `!`."""
    match part.event if isinstance(part, Guarded) else part:
        case Read(channel, _):
            return channel, "?"
        case Write(channel, _):
            return channel, "!"
        case _:
            return None
