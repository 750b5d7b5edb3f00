"""What must hold of the symbols of arrows: each stands where its arrow runs alone, or beside others of its own kind."""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.draw.scene.geometry import Point, Rectangle
from cspdiag.draw.scene.outline import ARROW_HALF_WIDTH, ARROW_LENGTH
from cspdiag.draw.scene.scene_geometry import bounds
from cspdiag.draw.scene.shapes import Box, Ellipse, Group, Head, Item, Line, Scene
from tests.draw.geometry.segments import Segment, crosses, stroked


def symbol_faults(scene: Scene) -> list[str]:
    """Symbols that stand on others, on lines of arrows that do not have them, or on the head of an arrow."""
    arrows = list(_arrows(scene.items))
    found = []
    for arrow in arrows:
        for symbol in _symbol(arrow):
            place = bounds(symbol)
            for other in arrows:
                if any((type(its), bounds(its)) == (type(symbol), place) for its in _symbol(other)):
                    continue  # of one kind; a mark may give it another ink
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
    """The room of an arrow head at the end of a line that comes from ``before``."""
    length = ARROW_LENGTH
    if before.y == end.y:
        left = end.x - length if before.x < end.x else end.x
        return Rectangle(left, end.y - ARROW_HALF_WIDTH, length, 2 * ARROW_HALF_WIDTH)
    top = end.y - length if before.y < end.y else end.y
    return Rectangle(end.x - ARROW_HALF_WIDTH, top, 2 * ARROW_HALF_WIDTH, length)
