"""What stands around a picture: its heading, its legend, and the messages that its marks refer to."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from cspdiag.diagnostics import Diagnostic
from cspdiag.draw.elements.marks import Mark, MarkKind
from cspdiag.draw.geometry import Point, Rectangle
from cspdiag.draw.scene import Anchor, Box, Face, Group, Ink, Item, Run, Text
from cspdiag.draw.symbols import INKS
from cspdiag.draw.text_metrics import ASCENT, line_height, runs_width, text_width

HEADING_SIZE = 16.0
NOTE_SIZE = 12.0
BADGE = 8.5
"""Half the height of a badge."""
SMALLEST_ROW = 520.0
"""Legends and messages are not broken to less than this width."""

_SIGNS: dict[MarkKind, str] = {
    "error": "!",
    "warning": "!",
    "added": "+",
    "removed": "−",  # noqa: RUF001
    "changed": "~",
    "highlighted": "•",
}


def heading(runs: Sequence[Run], doc: str | None) -> Group:
    """The name of what is drawn, at the origin, and below it the first sentence of its doc comment."""
    items: list[Item] = [Text(Point(0, ASCENT * HEADING_SIZE), tuple(runs), HEADING_SIZE)]
    if doc:
        y = line_height(HEADING_SIZE) + 4
        for line in wrapped(first_sentence(doc), NOTE_SIZE, 720):
            items.append(Text(Point(0, y + ASCENT * NOTE_SIZE), (Run(line, ink=Ink.FAINT),), NOTE_SIZE))
            y += line_height(NOTE_SIZE)
    return Group("heading", tuple(items))


def first_sentence(doc: str) -> str:
    """The beginning of a doc comment, on one line."""
    text = " ".join(doc.replace("`", "").split())
    end = text.find(". ")
    return text if end < 0 else text[: end + 1]


def wrapped(text: str, size: float, width: float, face: Face = Face.SANS) -> list[str]:
    """Lines of words, none wider than ``width`` pixels but for single words."""
    lines: list[str] = []
    for word in text.split():
        if lines and text_width(f"{lines[-1]} {word}", size, face) <= width:
            lines[-1] += f" {word}"
        else:
            lines.append(word)
    return lines


def badge(mark: Mark, centre: Point) -> Group:
    """A pill with the numbers of the messages that belong to a mark, or with the sign of the change."""
    ink, _ = INKS[mark.kind]
    text = ",".join(map(str, mark.numbers)) or _SIGNS[mark.kind]
    width = max(2 * BADGE, text_width(text, 11, Face.BOLD) + 9)
    place = Rectangle(centre.x - width / 2, centre.y - BADGE, width, 2 * BADGE)
    label = Text(Point(centre.x, centre.y + 4), (Run(text, Face.BOLD, Ink.PAPER),), 11, Anchor.MIDDLE)
    return Group(f"badge {mark.kind}", (Box(place, ink, Ink.PAPER, BADGE, 1.5), label), title=mark.note)


def messages(diagnostics: Iterable[tuple[int, Diagnostic]], width: float) -> Group:
    """The numbered messages, one below the other, from the origin down."""
    rows: list[Item] = []
    y = 0.0
    for number, diagnostic in diagnostics:
        mark = Mark("error" if diagnostic.severity == "error" else "warning", (number,))
        rows.append(badge(mark, Point(BADGE, y + BADGE)))
        ink, _ = INKS[mark.kind]
        code = Run(diagnostic.code, Face.BOLD, ink)
        place = f"{diagnostic.span.file}:{diagnostic.span.line}"
        indent = 2 * BADGE + 14
        first = runs_width((code,), NOTE_SIZE) + 6
        lines = wrapped(diagnostic.message, NOTE_SIZE, max(width, SMALLEST_ROW) - indent - first)
        for position, line in enumerate(lines):
            x = indent + first
            at = Point(x, y + ASCENT * NOTE_SIZE + 2)
            if position == 0:
                rows.append(Text(Point(indent, at.y), (code,), NOTE_SIZE))
            rows.append(Text(at, (Run(line),), NOTE_SIZE))
            y += line_height(NOTE_SIZE) + 2
        rows.append(Text(Point(indent + first, y + ASCENT * 11 + 1), (Run(place, Face.MONO, Ink.FAINT),), 11))
        y += line_height(11) + 9
    return Group("messages", tuple(rows))
