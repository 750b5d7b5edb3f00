"""Which end of a relationship is written at a place: where values come from, or where they go."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, TypeAlias

from cspdiag.editing.text_at import Token, reference_start

End: TypeAlias = Literal["source", "sink"]
Direction: TypeAlias = Literal["in", "out"]

_INNER: dict[End, Direction] = {"source": "out", "sink": "in"}
_OWN: dict[End, Direction] = {"source": "in", "sink": "out"}


def end_at(before: Sequence[Token], rules: frozenset[str]) -> End | None:
    """The end of an arrow or of an equation that a name after some tokens begins; None if it begins something else.
    ``rules`` are those of the grammar that it begins there.
    """
    if "endpoint" in rules:
        return "sink" if _follows_arrow(before) else "source"
    return "sink" if "equation" in rules else None


def _follows_arrow(before: Sequence[Token]) -> bool:
    position = len(before)
    while position > 0 and before[position - 1].text == ",":
        position = reference_start(before, position - 1)
    return position > 0 and before[position - 1].text == "->"


def inner_direction(end: End) -> Direction:
    """The direction of a port of an instance that can be an end."""
    return _INNER[end]


def own_direction(end: End, keyword: str) -> Direction:
    """The direction of a port named without an instance that can be an end in a definition with a keyword: that of the
    definition itself, but in an environment of the process that it is for, which is inside.
    """
    return _INNER[end] if keyword == "environment" else _OWN[end]
