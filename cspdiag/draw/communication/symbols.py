"""The shapes of communication diagrams: distinguishable without colour."""

from __future__ import annotations

from typing import Literal, TypeAlias

from cspdiag.draw.annotations import INKS
from cspdiag.draw.elements.diagram import Arrow, FlowKind, Store
from cspdiag.draw.elements.diagram import Box as InstanceBox
from cspdiag.draw.elements.marks import Mark
from cspdiag.draw.scene.geometry import Point, Rectangle
from cspdiag.draw.scene.shapes import Box, Dash, Ellipse, Ink, Item, Line

Symbol: TypeAlias = FlowKind | Literal["several"]
"""What an arrow begins with; ``several`` if instances of the process differ in the kind of channel."""

MARKED_WIDTH = 2.2
STACK = 5.0
"""How far the boxes behind the box of an array show above it; they are narrower by as much on each side."""
SIDE_BAR = 5.0
"""Between the double lines at the sides of a submodel."""
SYMBOL_DISTANCE = 11.0
"""From the beginning of an arrow to the middle of the symbol of its kind."""


def outline(mark: Mark | None, ink: Ink = Ink.BORDER) -> tuple[Ink, float, Dash]:
    """Ink, width and dash of the outline of an element."""
    if mark is None:
        return ink, 1.2, Dash.SOLID
    return INKS[mark.kind][0], MARKED_WIDTH, Dash.DASHED if mark.kind == "removed" else Dash.SOLID


def inside(mark: Mark | None, ink: Ink) -> Ink:
    """The ink of the inside of an element."""
    return ink if mark is None else INKS[mark.kind][1]


def instance(box: InstanceBox, place: Rectangle, mark: Mark | None = None) -> tuple[Item, ...]:
    """The shape of an instance: a process has round corners, a submodel double sides, a driver a chamfer, an unknown
    definition a dashed outline; an array has two more boxes behind it.
    """
    stroke, width, dash = outline(mark)
    shapes: list[Item] = []
    if box.size is not None:
        for step in (2, 1):
            behind = Rectangle(
                place.x + STACK * step, place.y - STACK * step, place.width - 2 * STACK * step, place.height
            )
            shapes.append(_body(box, behind, mark, plain=True))
    shapes.append(_body(box, place, mark))
    if box.kind == "submodel":
        for x in (place.x + SIDE_BAR, place.right - SIDE_BAR):
            shapes.append(Line((Point(x, place.y), Point(x, place.bottom)), stroke, min(width, 1.2), dash))
    if box.language is not None:
        shapes.append(_folded_corner(place, stroke, dash))
    return tuple(shapes)


def _body(box: InstanceBox, place: Rectangle, mark: Mark | None, *, plain: bool = False) -> Item:
    stroke, width, dash = outline(mark)
    match box.kind:
        case "process":
            fill = inside(mark, Ink.FRAME if box.inside is not None else Ink.PROCESS)
            return Box(place, fill, stroke, 0 if box.language else 9, width, dash)
        case "submodel":
            return Box(place, inside(mark, Ink.SUBMODEL), stroke, 0, width, dash)
        case "driver":
            cut = 9.0
            corners = (
                Point(place.x + cut, place.y),
                Point(place.right - cut, place.y),
                Point(place.right, place.y + cut),
                Point(place.right, place.bottom - cut),
                Point(place.right - cut, place.bottom),
                Point(place.x + cut, place.bottom),
                Point(place.x, place.bottom - cut),
                Point(place.x, place.y + cut),
            )
            return Line(corners, stroke, width, dash, closed=True, fill=inside(mark, Ink.PROCESS))
        case "unknown":
            return Box(place, inside(mark, Ink.PAPER), stroke, 0, width, dash if plain else Dash.DASHED)


def _folded_corner(place: Rectangle, stroke: Ink, dash: Dash) -> Item:
    fold = 10.0
    corner = (
        Point(place.right - fold, place.y),
        Point(place.right - fold, place.y + fold),
        Point(place.right, place.y + fold),
    )
    return Line(corner, stroke, 1.2, dash)


def store(form: Store, place: Rectangle, mark: Mark | None = None) -> tuple[Item, ...]:
    """The shape of a store: a variable has a thick left side and no right one, a declared channel is a pill."""
    stroke, width, dash = outline(mark)
    fill = inside(mark, Ink.VARIABLE)
    if form.form == "channel":
        return (Box(place, fill, stroke, place.height / 2, width, dash),)
    open_side = (
        Point(place.right, place.y),
        Point(place.x, place.y),
        Point(place.x, place.bottom),
        Point(place.right, place.bottom),
    )
    bar = (Point(place.x + 4, place.y), Point(place.x + 4, place.bottom))
    return (
        Box(place, fill, None),
        Line(open_side, stroke, width, dash),
        Line(bar, stroke, 1.2, dash),
    )


def sink(place: Rectangle, mark: Mark | None = None) -> tuple[Item, ...]:
    """The shape of a sink, three strokes that get shorter: values that arrive here are discarded."""
    stroke, width, _ = outline(mark, Ink.LINE)
    x, middle = place.x, place.centre.y
    return tuple(
        Line((Point(x + 4 * step, middle - length), Point(x + 4 * step, middle + length)), stroke, width)
        for step, length in enumerate((8.0, 5.0, 2.0))
    )


def port(at: Point, mark: Mark | None = None, *, is_connected: bool = True, inwards: float = 1) -> Item:
    """The shape of a port, a small square at the inner side of the border, empty if it is not connected. ``inwards`` is
    1 at the left side, -1 at the right.
    """
    stroke, width, _ = outline(mark)
    size = 5.0
    left = at.x if inwards > 0 else at.x - size
    fill = stroke if is_connected else inside(mark, Ink.PAPER)
    return Box(Rectangle(left, at.y - size / 2, size, size), fill, stroke, 0, min(width, 1.2))


def symbol_of(arrow: Arrow) -> Symbol | None:
    """The symbol with which an arrow begins: an event that all or one of several readers get is shown by the symbol for
    that; None if nothing is known.
    """
    if not arrow.kinds:
        return None
    if len(arrow.kinds) > 1:
        return "several"
    if arrow.kinds[0] == "event" and arrow.requested in ("broadcast", "any"):
        return "broadcast" if arrow.requested == "broadcast" else "any"
    return arrow.kinds[0]


def kind_symbol(symbol: Symbol, begin: Point, towards: Point, ink: Ink = Ink.LINE) -> tuple[Item, ...]:
    """The symbol of a kind of channel on the first part of an arrow; nothing for a rendezvous."""
    length = abs(towards.x - begin.x) + abs(towards.y - begin.y)
    if length == 0:
        return ()
    distance = SYMBOL_DISTANCE if length > SYMBOL_DISTANCE + 4 else length / 2
    dx, dy = (towards.x - begin.x) / length, (towards.y - begin.y) / length
    centre = begin.moved(dx * distance, dy * distance)
    match symbol:
        case "var":
            return (Box(_around(centre, 3.5), Ink.PAPER, ink),)
        case "broadcast":
            return (Ellipse(_around(centre, 3.5), ink, ink),)
        case "event":
            return (Ellipse(_around(centre, 3.5), Ink.PAPER, ink),)
        case "any":
            return (Line(_diamond(centre, 5), ink, closed=True, fill=Ink.PAPER),)
        case "sampled":
            return (_stroke(centre, dx, dy, 0, ink), _stroke(centre, dx, dy, 3.5, ink))
        case "buffer":
            return _cells(centre, ink)
        case "overwrite":
            return (*_cells(centre, ink), Line((centre.moved(-7, 6), centre.moved(7, -6)), ink, 1))
        case "several":
            return (
                Line((centre.moved(-4, -4), centre.moved(4, 4)), ink),
                Line((centre.moved(-4, 4), centre.moved(4, -4)), ink),
            )
        case "sync" | "constant" | "discard":
            return ()


def _around(centre: Point, reach: float) -> Rectangle:
    return Rectangle(centre.x - reach, centre.y - reach, 2 * reach, 2 * reach)


def _diamond(centre: Point, reach: float) -> tuple[Point, ...]:
    return (centre.moved(-reach, 0), centre.moved(0, -reach), centre.moved(reach, 0), centre.moved(0, reach))


def _stroke(centre: Point, dx: float, dy: float, along: float, ink: Ink) -> Item:
    at = centre.moved(dx * (along - 1.75), dy * (along - 1.75))
    return Line((at.moved(-dy * 5, -dx * 5), at.moved(dy * 5, dx * 5)), ink)


def _cells(centre: Point, ink: Ink) -> tuple[Item, ...]:
    return tuple(
        Box(Rectangle(centre.x - 7.5 + 5 * cell, centre.y - 4, 5, 8), Ink.PAPER, ink, 0, 1) for cell in range(3)
    )
