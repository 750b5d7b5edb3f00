"""What surrounds a picture: the heading, the legend, and the messages to which its marks refer."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from cspdiag.base import Diagnostic
from cspdiag.base.record import record
from cspdiag.draw.elements.marks import Mark, MarkKind
from cspdiag.draw.elements.texts import place_in_file
from cspdiag.draw.scene.geometry import Point, Rectangle
from cspdiag.draw.scene.shapes import Anchor, Box, Face, Group, Ink, Item, Text, TextRun
from cspdiag.draw.scene.text_metrics import ASCENT, line_height, runs_width, text_width

HEADING_SIZE = 16.0
NOTE_SIZE = 12.0
PLACE_SIZE = 11.0
BADGE = 8.5
"""Half the height of a badge."""
SMALLEST_ROW = 520.0
"""Legends and messages are not broken to less than this width."""

INKS: dict[MarkKind, tuple[Ink, Ink]] = {
    "error": (Ink.ERROR, Ink.ERROR_FILL),
    "warning": (Ink.WARNING, Ink.WARNING_FILL),
    "added": (Ink.ADDED, Ink.ADDED_FILL),
    "removed": (Ink.REMOVED, Ink.REMOVED_FILL),
    "changed": (Ink.CHANGED, Ink.CHANGED_FILL),
    "highlighted": (Ink.ACCENT, Ink.ACCENT_FILL),
}
"""The outline and the inside of what is marked."""

_SIGNS: dict[MarkKind, str] = {
    "error": "!",
    "warning": "!",
    "added": "+",
    "removed": "−",  # noqa: RUF001
    "changed": "Δ",
    "highlighted": "•",
}


def heading(runs: Sequence[TextRun], doc: str | None, mark: Mark | None = None) -> Group:
    """The name of what is drawn, at the origin, with the mark of the diagram, and below it the first sentence of its
    doc comment.
    """
    items: list[Item] = [Text(Point(0, ASCENT * HEADING_SIZE), tuple(runs), HEADING_SIZE)]
    if mark is not None:
        right = runs_width(runs, HEADING_SIZE) + BADGE + badge_width(mark) / 2
        items.append(badge(mark, Point(right, line_height(HEADING_SIZE) / 2)))
    if doc:
        y = line_height(HEADING_SIZE) + 4
        for line in typeset(first_sentence(doc), NOTE_SIZE, 720, Ink.FAINT):
            items.append(Text(Point(0, y + ASCENT * NOTE_SIZE), line, NOTE_SIZE))
            y += line_height(NOTE_SIZE)
    return Group("heading", tuple(items))


def first_sentence(doc: str) -> str:
    """The beginning of a doc comment, on one line."""
    text = " ".join(doc.split())
    end = text.find(". ")
    return text if end < 0 else text[: end + 1]


def wrapped(text: str, size: float, width: float, face: Face = Face.SANS) -> list[str]:
    """Lines of words, none wider than ``width`` pixels unless it is a single word."""
    lines: list[str] = []
    for word in text.split():
        if lines and text_width(f"{lines[-1]} {word}", size, face) <= width:
            lines[-1] += f" {word}"
        else:
            lines.append(word)
    return lines


def typeset(text: str, size: float, width: float, ink: Ink = Ink.TEXT) -> list[tuple[TextRun, ...]]:
    """Lines no wider than ``width`` pixels, except for single words; text between backticks is set as code, without
    them.
    """
    words: list[list[TextRun]] = []
    is_apart = True
    for position, piece in enumerate(text.split("`")):
        face = Face.MONO if position % 2 else Face.SANS
        for number, word in enumerate(piece.split(" ")):
            if number > 0 or is_apart:
                words.append([])
            is_apart = False
            if word:
                words[-1].append(TextRun(word, face, ink))
    lines: list[list[TextRun]] = []
    for word_runs in filter(None, words):
        extended = [*lines[-1], TextRun(" ", Face.SANS, ink), *word_runs] if lines else word_runs
        if lines and runs_width(extended, size) <= width:
            lines[-1] = extended
        else:
            lines.append(list(word_runs))
    return [_merged(line) for line in lines]


def _merged(runs: list[TextRun]) -> tuple[TextRun, ...]:
    """The runs, with adjacent ones of the same look merged."""
    merged: list[TextRun] = []
    for run in runs:
        if merged and (merged[-1].face, merged[-1].ink) == (run.face, run.ink):
            merged[-1] = TextRun(merged[-1].text + run.text, run.face, run.ink)
        else:
            merged.append(run)
    return tuple(merged)


def has_badge(mark: Mark) -> bool:
    """Whether a mark has a badge at its element; one that only highlights has a badge only if it has numbers."""
    return mark.kind != "highlighted" or bool(mark.numbers)


def badge_width(mark: Mark) -> float:
    """The width of a badge in pixels."""
    return max(2 * BADGE, text_width(_badge_text(mark), 11, Face.BOLD) + 9)


def _badge_text(mark: Mark) -> str:
    return ",".join(map(str, mark.numbers)) or _SIGNS[mark.kind]


def badge(mark: Mark, centre: Point) -> Group:
    """A pill with the numbers of the messages that belong to a mark, or with the sign of the change."""
    ink, _ = INKS[mark.kind]
    text, width = _badge_text(mark), badge_width(mark)
    place = Rectangle(centre.x - width / 2, centre.y - BADGE, width, 2 * BADGE)
    label = Text(Point(centre.x, centre.y + 4), (TextRun(text, Face.BOLD, Ink.PAPER),), 11, Anchor.MIDDLE)
    return Group(f"badge {mark.kind}", (Box(place, ink, Ink.PAPER, BADGE, 1.5), label), title=mark.note)


@record
class Note:
    """A line below a picture: a badge, a word in the ink of the badge, a sentence, and a place in the text."""

    mark: Mark
    code: str
    text: str
    place: str


def messages(diagnostics: Iterable[tuple[int, Diagnostic]], width: float) -> Group:
    """The numbered messages, one below the other, from the origin down."""
    rows = [
        Note(
            Mark("error" if diagnostic.severity == "error" else "warning", (number,)),
            diagnostic.code,
            diagnostic.message,
            place_in_file(diagnostic.span),
        )
        for number, diagnostic in diagnostics
    ]
    return notes(rows, width)


def notes(rows: Iterable[Note], width: float) -> Group:
    """Lines one below the other, from the origin down, broken at ``width``."""
    items: list[Item] = []
    y = 0.0
    for row in rows:
        items.append(badge(row.mark, Point(BADGE, y + BADGE)))
        ink, _ = INKS[row.mark.kind]
        indent = 2 * BADGE + 12
        code = TextRun(row.code, Face.BOLD, ink)
        first = indent + (runs_width((code,), NOTE_SIZE) + 6 if row.code else 0)
        if row.code:
            items.append(Text(Point(indent, y + ASCENT * NOTE_SIZE + 2), (code,), NOTE_SIZE))
        for line in typeset(row.text, NOTE_SIZE, max(width, SMALLEST_ROW) - first):
            items.append(Text(Point(first, y + ASCENT * NOTE_SIZE + 2), line, NOTE_SIZE))
            y += line_height(NOTE_SIZE) + 2
        if row.place:
            place = TextRun(row.place, Face.MONO, Ink.FAINT)
            items.append(Text(Point(first, y + ASCENT * PLACE_SIZE + 1), (place,), PLACE_SIZE))
            y += line_height(PLACE_SIZE)
        y += 8
    return Group("messages", tuple(items))
