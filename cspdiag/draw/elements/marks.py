"""Marks on elements: an error or a warning, or what changed between two versions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Literal, TypeAlias

from cspdiag.base import Diagnostic, Span
from cspdiag.base.record import record

MarkKind: TypeAlias = Literal["error", "warning", "added", "removed", "changed", "highlighted"]


@record
class Mark:
    """How an element is marked; ``numbers`` refer to the messages below the picture, ``note`` is for the tooltip."""

    kind: MarkKind
    numbers: tuple[int, ...] = ()
    note: str = ""


Marks: TypeAlias = Mapping[str, Mark]
"""By the key of the element."""


WHOLE = ""
"""The key of the mark of a diagram as a whole, for diagnostics that belong to none of its elements."""


def numbered(diagnostics: Iterable[Diagnostic]) -> dict[int, Diagnostic]:
    """Diagnostics by the numbers under which they are shown, from 1."""
    return dict(enumerate(diagnostics, 1))


def marks_of(places: Mapping[str, Sequence[Span]], diagnostics: Mapping[int, Diagnostic]) -> dict[str, Mark]:
    """The marks of elements, given the places in the text that each represents.

    A diagnostic belongs to the element with the smallest range that contains the place of the diagnostic (the first of
    equals). One whose place is in no element marks nothing. Elements at the other places of a diagnostic are
    highlighted with its number, if they have no mark of their own.
    """
    found: dict[str, list[int]] = {}
    for number, diagnostic in diagnostics.items():
        key = _owner(places, diagnostic.span)
        if key is not None:
            found.setdefault(key, []).append(number)
    marks = {key: _mark([diagnostics[number] for number in numbers], numbers) for key, numbers in found.items()}
    return marks | _related(places, diagnostics, marks)


def _related(
    places: Mapping[str, Sequence[Span]], diagnostics: Mapping[int, Diagnostic], marked: Marks
) -> dict[str, Mark]:
    found: dict[str, dict[int, str]] = {}
    for number, diagnostic in diagnostics.items():
        for label in diagnostic.all_labels:
            key = _owner(places, label.span)
            if key is not None and key not in marked:
                found.setdefault(key, {})[number] = label.message
    return {key: Mark("highlighted", tuple(messages), "\n".join(messages.values())) for key, messages in found.items()}


def mark_of_rest(diagnostics: Mapping[int, Diagnostic], placed: Iterable[Mark]) -> dict[str, Mark]:
    """The mark of the diagram for the diagnostics that belong to none of the marked elements."""
    numbers = {number for mark in placed if mark.kind != "highlighted" for number in mark.numbers}
    rest = [number for number in diagnostics if number not in numbers]
    return {WHOLE: _mark([diagnostics[number] for number in rest], rest)} if rest else {}


def _owner(places: Mapping[str, Sequence[Span]], span: Span) -> str | None:
    best: tuple[int, str] | None = None
    for key, ranges in places.items():
        for place in ranges:
            if place.source is span.source and place.start <= span.start and span.end <= place.end:
                size = place.end - place.start
                if best is None or size < best[0]:
                    best = size, key
    return None if best is None else best[1]


def _mark(diagnostics: list[Diagnostic], numbers: list[int]) -> Mark:
    is_error = any(diagnostic.severity == "error" for diagnostic in diagnostics)
    return Mark(
        kind="error" if is_error else "warning",
        numbers=tuple(numbers),
        note="\n".join(f"{diagnostic.code}: {diagnostic.message}" for diagnostic in diagnostics),
    )
