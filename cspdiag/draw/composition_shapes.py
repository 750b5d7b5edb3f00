"""The shapes of what has no parts: processes, guards, conditions, and the signs of operators.

A reader is notched and a writer pointed, as inputs and outputs are in SDL (ITU-T Z.100).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import assert_never

from cspdiag.draw import symbols
from cspdiag.draw.composition_blocks import (
    LINE,
    Block,
    Look,
    badges,
    centred,
    group,
    lines_of,
    look,
    width_of,
)
from cspdiag.draw.composition_tooltips import step_tooltip
from cspdiag.draw.elements.composition import Activity, Case, Guard, Handler
from cspdiag.draw.elements.diagram import Box as InstanceBox
from cspdiag.draw.elements.marks import Mark
from cspdiag.draw.geometry import Point, Rectangle
from cspdiag.draw.scene import Box, Ellipse, Face, Ink, Item, Line, Text
from cspdiag.draw.scene_geometry import moved

POINT = 10
"""How deep a notch is, or how far a point sticks out."""
HEAD = 9
"""The length of the arrow head of a priority."""
_LOWEST = 36
_ROOM = 20
"""Around the lines of a text, from top to bottom."""

Outline = Callable[[float, float, Look], Sequence[Item]]
"""Shapes for a width, a height and a look."""


def _box(radius: float) -> Outline:
    def outline(width: float, height: float, look: Look) -> Sequence[Item]:
        return [Box(Rectangle(0, 0, width, height), look.fill, look.stroke, radius, look.width, look.dash)]

    return outline


def _pill(width: float, height: float, look: Look) -> Sequence[Item]:
    return _box(height / 2 if height <= _LOWEST else _LOWEST / 2)(width, height, look)


def _instance(activity: Activity, mark: Mark | None) -> Outline:
    """As in communication diagrams."""
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
    """A triangle; for an exception it exclaims."""
    x, y = centre.x, centre.y
    outline = Line(
        (Point(x, y - 8), Point(x + 9, y + 7), Point(x - 9, y + 7)), stroke, 1.2, closed=True, fill=Ink.PAPER
    )
    if not exclaims:
        return [outline]
    bar = Line((Point(x, y - 3.5), Point(x, y + 1.5)), stroke, 1.6)
    return [outline, bar, Ellipse(Rectangle(x - 1, y + 3.4, 2, 2), stroke, None)]


def _shape(
    kind: str,
    key: str,
    texts: Callable[[Point], Sequence[Text]],
    size: tuple[float, float],
    outline: Outline,
    shown: Look,
    title: str,
    mark: Mark | None,
    inset: tuple[float, float] = (0, 0),
    sign: _Sign | None = None,
    link: str = "",
) -> Block:
    """A block of one shape around its texts; ``inset`` is what is missing of it on its axis at the left and the right."""
    text_width, height = size

    def block(wanted: float) -> Block:
        width = max(text_width, wanted)
        middle = height / 2
        shift = 0.0
        items: list[Item] = [*outline(width, height, shown)]
        if sign is not None:
            shift = sign[1] / 2
            left = (width - text_width) / 2 + _ROOM / 2 + 9
            items += [moved(item, left, middle) for item in sign[0]]
        items += texts(Point((width + inset[0] - inset[1]) / 2 + shift, middle))
        items += badges(mark, width)
        return Block(
            width,
            height,
            Point(inset[0], middle),
            Point(width, middle),
            width / 2,
            (group(kind, key, items, title, mark, link),),
            widened=block,
        )

    return block(0)


def activity_block(activity: Activity, mark: Mark | None, link: str = "") -> Block:
    """The shape of a process without parts."""
    lines = lines_of(activity.text)
    fill, outline, inset, face = Ink.PROCESS, _box(3), (0.0, 0.0), Face.SANS
    sign: _Sign | None = None
    match activity.form:
        case "run":
            outline = _instance(activity, mark)
        case "read":
            outline, inset = _notched, (POINT, 0)
        case "write":
            outline, inset = _pointed, (0, POINT)
        case "assign":
            fill, outline = Ink.VARIABLE, _box(0)
        case "skip" | "reset":
            outline = _pill
        case "wait":
            outline = _pill
            sign = _clock(look(mark, Ink.BORDER, fill))
        case "stop":
            outline = _octagon
        case "raise":
            outline = _pill
            sign = warning_sign(Point(0, 0), exclaims=True, stroke=look(mark, Ink.BORDER, fill).stroke), 22
        case _:
            assert_never(activity.form)
    size = _size(lines, face, inset, 0 if sign is None else sign[1])
    return _shape(
        f"instance {activity.kind}" if activity.form == "run" else f"step {activity.form}",
        activity.key,
        lambda centre: centred(lines, centre, face),
        size,
        outline,
        look(mark, Ink.BORDER, fill),
        step_tooltip(activity),
        mark,
        inset,
        sign,
        link,
    )


def _size(lines: Sequence[str], face: Face, inset: tuple[float, float], sign: float = 0) -> tuple[float, float]:
    width = max(width_of(lines, face) + _ROOM + sum(inset) + sign, 56)
    return width, max(len(lines) * LINE + _ROOM, _LOWEST)


def guard_block(guard: Guard, mark: Mark | None) -> Block:
    """The shape of a guard: that of what it does, on paper; its condition stands above."""
    conditions = [] if guard.condition is None else lines_of(f"when {guard.condition}", face=Face.ITALIC)
    lines = lines_of(guard.text)
    outline, inset = _pill, (0.0, 0.0)
    if guard.form in ("ready", "input"):
        outline, inset = _notched, (POINT, 0)
    elif guard.form == "output":
        outline, inset = _pointed, (0, POINT)
    widest = max([width_of(lines), *(width_of([line], Face.ITALIC) for line in conditions)])
    shown = look(mark, Ink.LINE, Ink.PAPER)
    sign = _clock(shown) if guard.form == "after" else None
    size = (
        max(widest + _ROOM + sum(inset) + (0 if sign is None else sign[1]), 56),
        max((len(lines) + len(conditions)) * LINE + _ROOM, _LOWEST),
    )

    def texts(centre: Point) -> Sequence[Text]:
        whole = len(lines) + len(conditions)
        top = centre.y - whole * LINE / 2
        upper = centred(conditions, Point(centre.x, top + len(conditions) * LINE / 2), Face.ITALIC, Ink.FAINT)
        return [*upper, *centred(lines, Point(centre.x, centre.y + len(conditions) * LINE / 2))]

    tooltip = step_tooltip(guard)
    return _shape(f"guard {guard.form}", guard.key, texts, size, outline, shown, tooltip, mark, inset, sign)


def exception_block(handler: Handler, mark: Mark | None) -> Block:
    """The name of an exception that is caught."""
    lines = [handler.exception or ""]
    return _shape(
        "exception",
        handler.key,
        lambda centre: centred(lines, centre),
        _size(lines, Face.SANS, (0, 0)),
        _pill,
        look(mark, Ink.LINE, Ink.PAPER),
        step_tooltip(handler),
        mark,
    )


def condition_block(case: Case, mark: Mark | None, *, is_first: bool) -> Block:
    """A condition that is tested once."""
    lines = lines_of(f"{'if' if is_first else 'else if'} {case.condition}")
    return _shape(
        "condition",
        case.key,
        lambda centre: centred(lines, centre),
        _size(lines, Face.SANS, (POINT, POINT)),
        _hexagon,
        look(mark, Ink.LINE, Ink.PAPER),
        step_tooltip(case),
        mark,
    )


def operator_sign(
    operator: str, prioritized: bool, centre: Point, way: tuple[float, float] = (0, 1)
) -> tuple[list[Item], float, float]:
    """The sign of a relation around a point of its line, which leads ``way``; how far it reaches back and on along that line.

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
