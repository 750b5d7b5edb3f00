"""Lines as they are drawn: bends rounded, ends cut back for their heads, heads as shapes."""

from __future__ import annotations

from math import hypot

from cspdiag.draw.scene.geometry import Point, Rectangle
from cspdiag.draw.scene.shapes import Close, Command, CubicTo, Curve, Ellipse, Head, Ink, Line, LineTo, MoveTo

ARROW_LENGTH = 9.0
ARROW_HALF_WIDTH = 3.6
OPEN_ARROW_LENGTH = 7.0
OPEN_ARROW_HALF_WIDTH = 4.2
CIRCLE_RADIUS = 3.6
DOT_RADIUS = 2.8
BAR_HALF_WIDTH = 5.0

_ROUND = 0.5523
"""How far the handles reach of a cubic that approximates a quarter of a circle, as a fraction of the radius."""

_TRIMMED = {Head.ARROW: ARROW_LENGTH - 1, Head.CIRCLE: 2 * CIRCLE_RADIUS}


def shapes(line: Line) -> tuple[Curve | Ellipse, ...]:
    """The line itself and its heads, in the order in which they are drawn."""
    points = _without_repetition(line.points)
    if len(points) < 2:
        return ()
    heads: list[Curve | Ellipse] = []
    if not line.closed:
        heads += _head(line, line.start, points[1], points[0])
        heads += _head(line, line.end, points[-2], points[-1])
        points[0] = _towards(points[0], points[1], _TRIMMED.get(line.start, 0))
        points[-1] = _towards(points[-1], points[-2], _TRIMMED.get(line.end, 0))
    return (Curve(_path(points, line), line.stroke, line.fill, line.width, line.dash), *heads)


def _without_repetition(points: tuple[Point, ...]) -> list[Point]:
    kept: list[Point] = []
    for point in points:
        if not kept or point != kept[-1]:
            kept.append(point)
    return kept


def _towards(start: Point, end: Point, distance: float) -> Point:
    length = hypot(end.x - start.x, end.y - start.y)
    part = min(distance / length, 1) if length else 0
    return Point(start.x + (end.x - start.x) * part, start.y + (end.y - start.y) * part)


def _path(points: list[Point], line: Line) -> tuple[Command, ...]:
    if line.closed or line.corner <= 0:
        straight: list[Command] = [MoveTo(points[0]), *(LineTo(point) for point in points[1:])]
        return (*straight, Close()) if line.closed else tuple(straight)
    commands: list[Command] = [MoveTo(points[0])]
    for before, bend, after in zip(points, points[1:], points[2:], strict=False):
        room = min(hypot(bend.x - each.x, bend.y - each.y) / 2 for each in (before, after))
        radius = min(line.corner, room)
        begin, end = _towards(bend, before, radius), _towards(bend, after, radius)
        handle = radius * (1 - _ROUND)
        commands += [LineTo(begin), CubicTo(_towards(bend, before, handle), _towards(bend, after, handle), end)]
    return (*commands, LineTo(points[-1]))


def _head(line: Line, head: Head, before: Point, end: Point) -> list[Curve | Ellipse]:
    """The shapes of a head at ``end`` of a line that comes from ``before``."""
    length = hypot(end.x - before.x, end.y - before.y)
    along, across = (end.x - before.x) / length, (end.y - before.y) / length

    def at(back: float, aside: float) -> Point:
        return Point(end.x - along * back - across * aside, end.y - across * back + along * aside)

    ink = line.stroke or Ink.LINE
    match head:
        case Head.NONE:
            return []
        case Head.ARROW:
            corners = (end, at(ARROW_LENGTH, ARROW_HALF_WIDTH), at(ARROW_LENGTH, -ARROW_HALF_WIDTH))
            outline: list[Command] = [MoveTo(corners[0]), *(LineTo(corner) for corner in corners[1:]), Close()]
            return [Curve(tuple(outline), None, ink)]
        case Head.OPEN_ARROW:
            first, second = (at(OPEN_ARROW_LENGTH, side * OPEN_ARROW_HALF_WIDTH) for side in (1, -1))
            return [Curve((MoveTo(first), LineTo(end), LineTo(second)), ink, None, line.width)]
        case Head.CIRCLE:
            return [_disc(at(CIRCLE_RADIUS, 0), CIRCLE_RADIUS, Ink.PAPER, ink, line.width)]
        case Head.DOT:
            return [_disc(end, DOT_RADIUS, ink, None, line.width)]
        case Head.BAR:
            return [Curve((MoveTo(at(0, BAR_HALF_WIDTH)), LineTo(at(0, -BAR_HALF_WIDTH))), ink, None, line.width)]


def _disc(centre: Point, radius: float, fill: Ink, stroke: Ink | None, width: float) -> Ellipse:
    place = Rectangle(centre.x - radius, centre.y - radius, 2 * radius, 2 * radius)
    return Ellipse(place, fill, stroke, width)
