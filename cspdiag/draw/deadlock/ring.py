"""Draws a deadlock: the processes that wait for each other as a ring, and where they are in the communication diagram
around them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise

from cspdiag.base import Span
from cspdiag.base.record import EMPTY, record
from cspdiag.draw.annotations import NOTE_SIZE, badge, heading, wrapped
from cspdiag.draw.communication.diagram import draw_communication
from cspdiag.draw.composition.diagram import draw_composition
from cspdiag.draw.deadlock.marks import StuckProcess, shortened, surroundings
from cspdiag.draw.deadlock.steps import waiting_steps
from cspdiag.draw.elements.marks import Mark
from cspdiag.draw.scene.geometry import Point, Rectangle
from cspdiag.draw.scene.scene_geometry import below_each_other, fitted, stacked
from cspdiag.draw.scene.shapes import Box, Face, Group, Head, Ink, Item, Line, Scene, Text, TextRun
from cspdiag.draw.scene.text_metrics import ASCENT, line_height, text_width
from cspdiag.model.program import Program

_ACROSS = 56.0
_DOWN = 44.0
"""Between the boxes of a ring, from left to right and from top to bottom."""
_COMPOSITIONS = 4
"""The number of compositions that are shown at most."""
_COLUMNS = 6
"""The number of columns beyond which a ring grows downwards."""
_PADDING = 12.0
_WIDEST = 300.0
_NAME_SIZE = 13.0
_PLACE_SIZE = 11.0


@record
class Deadlock:
    """The processes that wait when nothing continues. In ``cycle`` each waits for the next and the last for the first;
    it may be empty. ``besides`` are the other waiting processes. ``declared`` is where the channels are declared, by
    their full names. ``title`` says what happened and when (``deadlock at 10 ms``), ``top`` is the name of the
    outermost process.
    """

    title: str
    top: str
    cycle: tuple[StuckProcess, ...]
    besides: tuple[StuckProcess, ...] = ()
    declared: Mapping[str, Span] = EMPTY


def draw_deadlock(deadlock: Deadlock, program: Program | None = None) -> Scene:
    """The ring of waiting processes and, given the program, the communication diagram around them and their
    compositions, with them highlighted.

    Numbers show which box and which step belongs to which process of the ring; a composition is shown if it is known at
    which step a process waits. Raises the same exceptions as ``lay_out``.
    """
    ring = draw_ring(deadlock)
    if program is None:
        return ring
    around = surroundings(program, deadlock.top, deadlock.cycle or deadlock.besides, deadlock.declared)
    if around is None:
        return ring
    scenes = [ring, draw_communication(around[0], marks=around[1])]
    for composition, marks in waiting_steps(program, deadlock.cycle or deadlock.besides)[:_COMPOSITIONS]:
        scenes.append(draw_composition(composition, marks=marks))
    return stacked(scenes)


def draw_ring(deadlock: Deadlock) -> Scene:
    """The waiting processes alone, which needs no layout engine."""
    title = (TextRun(deadlock.title, Face.BOLD, Ink.ACCENT), TextRun(f" in {deadlock.top}"))
    explained = (
        "each process waits for the one that its arrow leads to"
        if deadlock.cycle
        else "nothing that a process waits for can happen any more"
    )
    parts: list[Item] = [heading(title, explained)]
    if deadlock.cycle:
        parts.append(Group("ring", tuple(_ring(deadlock.cycle, deadlock.top))))
        if deadlock.besides:
            parts.append(Group("besides", tuple(_list("besides:", deadlock.besides, deadlock.top))))
    elif deadlock.besides:
        parts.append(Group("ring", tuple(_grid(deadlock.besides, deadlock.top))))
    return fitted(below_each_other(parts, 22), title=deadlock.title, description=explained, name="deadlock")


def _ring(cycle: Sequence[StuckProcess], top: str) -> Iterator[Item]:
    cards = [_lines(waiting, top) for waiting in cycle]
    width, height = _size(cards)
    slots = _slots(len(cycle))
    places = [Rectangle(column * (width + _ACROSS), row * (height + _DOWN), width, height) for column, row in slots]
    for first, second in pairwise(places):
        yield _arrow([first.centre, second.centre], first, second)
    yield _arrow([places[-1].centre, *_bend(places, slots), places[0].centre], places[-1], places[0])
    for number, (waiting, card, place) in enumerate(zip(cycle, cards, places, strict=True), 1):
        yield _card(waiting, card, place, Mark("highlighted", (number,)))


def _slots(count: int) -> list[tuple[int, int]]:
    """Columns and rows around a rectangle, clockwise from its upper left corner; the last one may be free."""
    columns = min(max((count + 1) // 2, 1), _COLUMNS)
    if count == 2:
        return [(0, 0), (1, 0)]
    rows = max(2, (count - 2 * columns + 1) // 2 + 2)
    upper = [(column, 0) for column in range(columns)]
    right = [(columns - 1, row) for row in range(1, rows - 1)]
    lower = [(column, rows - 1) for column in reversed(range(columns))]
    left = [(0, row) for row in reversed(range(1, rows - 1))]
    return [*upper, *right, *lower, *left][:count]


def _bend(places: Sequence[Rectangle], slots: Sequence[tuple[int, int]]) -> list[Point]:
    """Where the line from the last process back to the first bends."""
    last, first = places[-1], places[0]
    if len(places) == 1:
        right, low = last.right + _ACROSS / 2, last.bottom + _DOWN / 2
        return [Point(right, last.centre.y), Point(right, low), Point(first.centre.x, low)]
    if slots[-1][0] == slots[0][0]:
        return []
    if slots[-1][1] == slots[0][1]:
        low = last.bottom + _DOWN / 2
        return [Point(last.centre.x, low), Point(first.centre.x, low)]
    return [Point(first.centre.x, last.centre.y)]


def _arrow(points: Sequence[Point], first: Rectangle, second: Rectangle) -> Line:
    """A line between the borders of two boxes, given by its points from centre to centre."""
    ends = [_border(first, points[1]), *points[1:-1], _border(second, points[-2])]
    return Line(tuple(ends), Ink.ACCENT, 2, end=Head.ARROW, corner=5)


def _border(place: Rectangle, towards: Point) -> Point:
    """Where the straight line from the centre to a point above, below, or to the left or right of the box meets its
    border.
    """
    centre = place.centre
    if abs(towards.x - centre.x) > abs(towards.y - centre.y):
        return Point(place.right if towards.x > centre.x else place.x, centre.y)
    return Point(centre.x, place.bottom if towards.y > centre.y else place.y)


def _grid(waiting: Sequence[StuckProcess], top: str) -> Iterator[Item]:
    cards = [_lines(each, top) for each in waiting]
    width, height = _size(cards)
    columns = min(len(cards), 4)
    for number, (each, card) in enumerate(zip(waiting, cards, strict=True)):
        row, column = divmod(number, columns)
        place = Rectangle(column * (width + 24), row * (height + 24), width, height)
        yield _card(each, card, place, Mark("highlighted", (number + 1,)))


_Card = list[tuple[TextRun, float]]


def _lines(waiting: StuckProcess, top: str) -> _Card:
    name = TextRun(shortened(waiting.path, top) or top, Face.BOLD)
    words = wrapped(f"waits {shortened(waiting.words, top)}", NOTE_SIZE, _WIDEST)
    lines = [(name, _NAME_SIZE), *((TextRun(line), NOTE_SIZE) for line in words)]
    if waiting.place is not None:
        lines.append((TextRun(waiting.place, Face.MONO, Ink.FAINT), _PLACE_SIZE))
    return lines


def _size(cards: Sequence[_Card]) -> tuple[float, float]:
    width = max(text_width(run.text, size, run.face) for card in cards for run, size in card)
    height = max(sum(line_height(size) + 3 for _, size in card) for card in cards)
    return max(width, 110) + 2 * _PADDING, height + 2 * _PADDING - 3


def _card(waiting: StuckProcess, card: _Card, place: Rectangle, mark: Mark) -> Group:
    items: list[Item] = [Box(place, Ink.ACCENT_FILL, Ink.ACCENT, 9, 2.2)]
    y = place.y + _PADDING
    for run, size in card:
        items.append(Text(Point(place.x + _PADDING, y + ASCENT * size), (run,), size))
        y += line_height(size) + 3
    items.append(badge(mark, Point(place.right - 4, place.y)))
    return Group("waiting", tuple(items), f"waiting-{waiting.path}", f"{waiting.path} waits {waiting.words}")


def _list(title: str, waiting: Sequence[StuckProcess], top: str) -> Iterator[Item]:
    y = ASCENT * NOTE_SIZE
    yield Text(Point(0, y), (TextRun(title, Face.BOLD),), NOTE_SIZE)
    for each in waiting:
        y += line_height(NOTE_SIZE) + 4
        words = (
            TextRun(shortened(each.path, top) or top, Face.BOLD),
            TextRun(f" waits {shortened(each.words, top)}"),
            *((TextRun(f"  {each.place}", ink=Ink.FAINT),) if each.place is not None else ()),
        )
        yield Text(Point(12, y), words, NOTE_SIZE)
