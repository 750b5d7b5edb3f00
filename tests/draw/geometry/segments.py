"""The visible lines of a drawing as straight pieces, and what they cross."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from cspdiag.draw.scene import outline
from cspdiag.draw.scene.geometry import Point, Rectangle
from cspdiag.draw.scene.shapes import Box, Close, CubicTo, Curve, Ellipse, Item, Line, LineTo, MoveTo

Segment = tuple[Point, Point]


def stroked(item: Item) -> Iterator[Segment]:
    """The visible lines of an item as straight pieces."""
    match item:
        case Line():
            for shape in outline.shapes(item):
                yield from stroked(shape)
        case Box() if item.stroke:
            place = item.place
            corners = [(place.x, place.y), (place.right, place.y), (place.right, place.bottom), (place.x, place.bottom)]
            yield from pairwise([Point(x, y) for x, y in (*corners, corners[0])])
        case Ellipse() if item.stroke:
            place, c = item.place, item.place.centre
            diamond = [(place.x, c.y), (c.x, place.y), (place.right, c.y), (c.x, place.bottom), (place.x, c.y)]
            yield from pairwise([Point(x, y) for x, y in diamond])
        case Curve() if item.stroke:
            yield from _curve(item)
        case _:
            pass


def _curve(curve: Curve) -> Iterator[Segment]:
    start = at = Point(0, 0)
    for command in curve.commands:
        match command:
            case MoveTo():
                start = at = command.to
            case LineTo() | CubicTo():
                # The chord of a rounded corner differs from it by less than a letter.
                yield at, command.to
                at = command.to
            case Close():
                yield at, start
                at = start


def crosses(place: Rectangle, first: Point, second: Point) -> bool:
    """Whether a piece of a line has a point inside a rectangle (clipping by Liang and Barsky)."""
    dx, dy = second.x - first.x, second.y - first.y
    enter, leave = 0.0, 1.0
    for step, distance in (
        (-dx, first.x - place.x),
        (dx, place.right - first.x),
        (-dy, first.y - place.y),
        (dy, place.bottom - first.y),
    ):
        if step == 0:
            if distance <= 0:
                return False
        elif step < 0:
            enter = max(enter, distance / step)
        else:
            leave = min(leave, distance / step)
    return enter < leave
