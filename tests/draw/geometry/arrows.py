"""Rules for arrows: each has its symbol where it runs alone, or next to others of its own kind, and none runs along the
side of a shape.
"""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.draw.scene.geometry import Point, Rectangle
from cspdiag.draw.scene.outline import ARROW_HALF_WIDTH, ARROW_LENGTH
from cspdiag.draw.scene.scene_geometry import bounds, every
from cspdiag.draw.scene.shapes import Box, Ellipse, Group, Head, Item, Line, Scene
from tests.draw.geometry.segments import Segment, crosses, stroked


def symbol_faults(scene: Scene) -> list[str]:
    """Symbols that overlap others, lines of other arrows, or the head of an arrow."""
    arrows = list(_arrows(scene.items))
    found = []
    for arrow in arrows:
        for symbol in _symbol(arrow):
            place = bounds(symbol)
            for other in arrows:
                if any((type(its), bounds(its)) == (type(symbol), place) for its in _symbol(other)):
                    continue  # of the same kind; a mark may give it another colour
                if any(place.overlaps(bounds(its)) for its in _symbol(other)):
                    found.append(f"a symbol of {arrow.id!r} lies on one of {other.id!r}")
                if any(crosses(place, *piece) for piece in _run(other)):
                    found.append(f"{other.id!r} runs through a symbol of {arrow.id!r}")
            found += [
                f"a symbol of {arrow.id!r} lies on the head of {other.id!r}"
                for other in arrows
                if any(place.overlaps(head) for head in _heads(other))
            ]
    return found


def sides_run_along(scene: Scene) -> list[str]:
    """Arrows of which a part lies on the outline of a box, or of the boxes behind it."""
    sides = [
        (item.id, side)
        for item in every(scene.items)
        if isinstance(item, Group) and item.kind.startswith("instance")
        for shape in item.items
        for side in stroked(shape)
    ]
    return [
        f"{arrow.id!r} runs along a side of {box!r}"
        for arrow in _arrows(scene.items)
        for piece in _run(arrow)
        for box, side in sides
        if _on_one_line(piece, side)
    ]


def _on_one_line(one: Segment, other: Segment) -> bool:
    """Whether two vertical or two horizontal pieces have more than a point in common."""
    across = [{point.x for point in (*one, *other)}, {point.y for point in (*one, *other)}]
    for same, along in (across, reversed(across)):
        if max(same) - min(same) < 1:
            return len(along) > 1 and _length(one) + _length(other) > max(along) - min(along) + 1
    return False


def _length(piece: Segment) -> float:
    return abs(piece[0].x - piece[1].x) + abs(piece[0].y - piece[1].y)


def _arrows(items: tuple[Item, ...]) -> Iterator[Group]:
    for item in items:
        if isinstance(item, Group):
            is_arrow = any(isinstance(each, Line) and each.corner > 0 for each in item.items)
            if is_arrow and item.kind.split(" ")[0] in {"channel", "communication"}:
                yield item
            yield from _arrows(item.items)


def _is_symbol(item: Item) -> bool:
    if isinstance(item, Line):
        return item.corner == 0 and item.start is Head.NONE
    return isinstance(item, Box | Ellipse)


def _symbol(arrow: Group) -> list[Item]:
    return [item for item in arrow.items if _is_symbol(item)]


def _run(arrow: Group) -> Iterator[Segment]:
    for item in arrow.items:
        if isinstance(item, Line) and not _is_symbol(item):
            yield from stroked(item)


def _heads(arrow: Group) -> Iterator[Rectangle]:
    for item in arrow.items:
        if isinstance(item, Line) and item.end is Head.ARROW:
            (before, end) = item.points[-2:]
            yield _head(before, end)


def _head(before: Point, end: Point) -> Rectangle:
    """The area of an arrow head at the end of a line that comes from ``before``."""
    length = ARROW_LENGTH
    if before.y == end.y:
        left = end.x - length if before.x < end.x else end.x
        return Rectangle(left, end.y - ARROW_HALF_WIDTH, length, 2 * ARROW_HALF_WIDTH)
    top = end.y - length if before.y < end.y else end.y
    return Rectangle(end.x - ARROW_HALF_WIDTH, top, 2 * ARROW_HALF_WIDTH, length)
