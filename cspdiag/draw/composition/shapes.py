"""The shapes of elements without parts (processes, guards, conditions) and the signs of operators.

A reader is notched and a writer pointed, as inputs and outputs are in SDL (ITU-T Z.100).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import assert_never

from cspdiag.base.record import record
from cspdiag.draw.communication import symbols
from cspdiag.draw.composition.blocks import LINE, SIZE, Block, Look, badges, centred, group, lines_of, look
from cspdiag.draw.composition.tooltips import step_tooltip
from cspdiag.draw.elements.composition import Activity, Case, Guard, Handler
from cspdiag.draw.elements.diagram import Box as InstanceBox
from cspdiag.draw.elements.marks import Mark
from cspdiag.draw.scene.geometry import Point, Rectangle
from cspdiag.draw.scene.scene_geometry import moved
from cspdiag.draw.scene.shapes import Box, Ellipse, Face, Ink, Item, Line, Text, TextRun
from cspdiag.draw.scene.text_metrics import text_width

POINT = 10
"""How deep a notch is, or how far a point sticks out."""
HEAD = 9
"""The length of the arrow head of a priority."""
_LOWEST = 36
_ROOM = 20
"""The room around the lines of a text, at the top and the bottom together."""

Outline = Callable[[float, float, Look], Sequence[Item]]
"""Shapes for a width, a height and a look."""


def _box(radius: float) -> Outline:
    def outline(width: float, height: float, look: Look) -> Sequence[Item]:
        return [Box(Rectangle(0, 0, width, height), look.fill, look.stroke, radius, look.width, look.dash)]

    return outline


def _pill(width: float, height: float, look: Look) -> Sequence[Item]:
    return _box(height / 2 if height <= _LOWEST else _LOWEST / 2)(width, height, look)


def _instance(activity: Activity, mark: Mark | None) -> Outline:
    """The shape of an instance, as in communication diagrams."""
    box = InstanceBox(
        key=activity.key, kind=activity.kind, definition=activity.definition or "", language=activity.language
    )

    def outline(width: float, height: float, look: Look) -> Sequence[Item]:
        return symbols.instance(box, Rectangle(0, 0, width, height), mark)

    return outline


def _polygon(points: Sequence[tuple[float, float]], look: Look) -> Line:
    return Line(tuple(Point(x, y) for x, y in points), look.stroke, look.width, look.dash, closed=True, fill=look.fill)


def _notched(width: float, height: float, look: Look) -> Sequence[Item]:
    return [_polygon([(0, 0), (width, 0), (width, height), (0, height), (POINT, height / 2)], look)]


def _pointed(width: float, height: float, look: Look) -> Sequence[Item]:
    corner = width - POINT
    return [_polygon([(0, 0), (corner, 0), (width, height / 2), (corner, height), (0, height)], look)]


def _hexagon(width: float, height: float, look: Look) -> Sequence[Item]:
    left, right, middle = POINT, width - POINT, height / 2
    return [_polygon([(left, 0), (right, 0), (width, middle), (right, height), (left, height), (0, middle)], look)]


def _octagon(width: float, height: float, look: Look) -> Sequence[Item]:
    cut, right, low = 10, width - 10, height - 10
    points = [(cut, 0), (right, 0), (width, cut), (width, low), (right, height), (cut, height), (0, low), (0, cut)]
    return [_polygon([(float(x), float(y)) for x, y in points], look)]


_Sign = tuple[Sequence[Item], float]
"""A sign around (0, 0), and the room that it takes before a text."""


def _clock(look: Look) -> _Sign:
    hands = Line((Point(0, -4), Point(0, 0), Point(3, 1.5)), look.stroke, 1.2)
    return [Ellipse(Rectangle(-6.5, -6.5, 13, 13), Ink.PAPER, look.stroke, 1.2), hands], 20


def warning_sign(centre: Point, *, exclaims: bool, stroke: Ink = Ink.LINE) -> list[Item]:
    """A triangle, with an exclamation mark for an exception."""
    x, y = centre.x, centre.y
    outline = Line(
        (Point(x, y - 8), Point(x + 9, y + 7), Point(x - 9, y + 7)), stroke, 1.2, closed=True, fill=Ink.PAPER
    )
    if not exclaims:
        return [outline]
    bar = Line((Point(x, y - 3.5), Point(x, y + 1.5)), stroke, 1.6)
    return [outline, bar, Ellipse(Rectangle(x - 1, y + 3.4, 2, 2), stroke, None)]


@record
class _Form:
    """An outline; ``inset`` is how far it is indented on its axis at the left and the right, ``sign`` precedes the
    text.
    """

    outline: Outline
    inset: tuple[float, float] = (0, 0)
    sign: _Sign | None = None


@record
class _Owner:
    """The element of a shape: class, key, tooltip, mark, and the address of its link."""

    kind: str
    key: str
    title: str
    mark: Mark | None
    link: str = ""


_READER = _Form(_notched, (POINT, 0))
_WRITER = _Form(_pointed, (0, POINT))


def _shape(owner: _Owner, lines: Sequence[TextRun], form: _Form, shown: Look) -> Block:
    """A block of one shape around lines of text."""
    sign, room = form.sign or ((), 0)
    widest = max(text_width(line.text, SIZE, line.face) for line in lines)
    narrowest = max(widest + _ROOM + sum(form.inset) + room, 56)
    height = max(len(lines) * LINE + _ROOM, _LOWEST)

    def block(wanted: float) -> Block:
        width = max(narrowest, wanted)
        middle = height / 2
        beside = (width - narrowest) / 2 + _ROOM / 2 + 9
        centre = Point((width + form.inset[0] - form.inset[1] + room) / 2, middle)
        items: list[Item] = [
            *form.outline(width, height, shown),
            *(moved(item, beside, middle) for item in sign),
            *_centred(lines, centre),
            *badges(owner.mark, width),
        ]
        drawn = group(owner.kind, owner.key, items, owner.title, owner.mark, owner.link)
        entry, leave = Point(form.inset[0], middle), Point(width, middle)
        return Block(width, height, entry, leave, width / 2, (drawn,), widened=block)

    return block(0)


def _centred(lines: Sequence[TextRun], centre: Point) -> Iterator[Text]:
    for number, line in enumerate(lines):
        at = centre.moved(0, (number - (len(lines) - 1) / 2) * LINE)
        yield from centred([line.text], at, line.face, line.ink)


def _plain(text: str) -> list[TextRun]:
    return [TextRun(line) for line in lines_of(text)]


def activity_block(activity: Activity, mark: Mark | None, link: str = "") -> Block:
    """The shape of a process without parts."""
    kind = f"instance {activity.kind}" if activity.form == "run" else f"step {activity.form}"
    owner = _Owner(kind, activity.key, step_tooltip(activity), mark, link)
    shown = look(mark, Ink.BORDER, Ink.VARIABLE if activity.form == "assign" else Ink.PROCESS)
    return _shape(owner, _plain(activity.text), _activity_form(activity, mark, shown), shown)


def _activity_form(activity: Activity, mark: Mark | None, shown: Look) -> _Form:
    match activity.form:
        case "run":
            return _Form(_instance(activity, mark))
        case "read":
            return _READER
        case "write":
            return _WRITER
        case "assign":
            return _Form(_box(0))
        case "skip" | "reset":
            return _Form(_pill)
        case "wait":
            return _Form(_pill, sign=_clock(shown))
        case "stop":
            return _Form(_octagon)
        case "raise":
            return _Form(_pill, sign=(warning_sign(Point(0, 0), exclaims=True, stroke=shown.stroke), 22))
        case _:
            assert_never(activity.form)


def guard_block(guard: Guard, mark: Mark | None) -> Block:
    """The shape of a guard, which depends on what it does, on paper; its condition is above."""
    condition = [] if guard.condition is None else lines_of(f"when {guard.condition}", face=Face.ITALIC)
    shown = look(mark, Ink.LINE, Ink.PAPER)
    form = _Form(_pill, sign=_clock(shown) if guard.form == "after" else None)
    if guard.form in ("ready", "input"):
        form = _READER
    elif guard.form == "output":
        form = _WRITER
    lines = [*(TextRun(line, Face.ITALIC, Ink.FAINT) for line in condition), *_plain(guard.text)]
    return _shape(_Owner(f"guard {guard.form}", guard.key, step_tooltip(guard), mark), lines, form, shown)


def exception_block(handler: Handler, mark: Mark | None) -> Block:
    """The shape of an exception that is caught."""
    owner = _Owner("exception", handler.key, step_tooltip(handler), mark)
    return _shape(owner, _plain(handler.exception or ""), _Form(_pill), look(mark, Ink.LINE, Ink.PAPER))


def condition_block(case: Case, mark: Mark | None, *, is_first: bool) -> Block:
    """The shape of a condition that is tested once."""
    owner = _Owner("condition", case.key, step_tooltip(case), mark)
    lines = _plain(f"{'if' if is_first else 'else if'} {case.condition}")
    return _shape(owner, lines, _Form(_hexagon, (POINT, POINT)), look(mark, Ink.LINE, Ink.PAPER))


def operator_sign(
    operator: str, prioritized: bool, centre: Point, way: tuple[float, float] = (0, 1)
) -> tuple[list[Item], float, float]:
    """The sign of a relation around a point of its line, which leads ``way``, and how far it reaches backwards and
    forwards along that line.

    The arrow head of priority points from the higher to the lower.
    """
    x, y = centre.x, centre.y
    items: list[Item]
    if operator == "parallel":
        items = [Line((Point(x + dx, y - 7), Point(x + dx, y + 7)), Ink.LINE, 1.8) for dx in (-3.5, 3.5)]
        reach = 10.0 if way[1] else 7.0
        base = reach
    else:
        items = [Box(Rectangle(x - 6.5, y - 6.5, 13, 13), Ink.PAPER, Ink.LINE, 0, 1.6)]
        reach, base = 6.5, 9.0
    if not prioritized:
        return items, reach, reach
    foot, tip = centre.moved(way[0] * base, way[1] * base), centre.moved(way[0] * (base + HEAD), way[1] * (base + HEAD))
    head = (foot.moved(5 * way[1], 5 * way[0]), foot.moved(-5 * way[1], -5 * way[0]), tip)
    items.append(Line(head, Ink.LINE, closed=True, fill=Ink.LINE))
    return items, reach, base + HEAD
