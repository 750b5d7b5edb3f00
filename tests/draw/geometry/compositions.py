"""Measures a drawn composition diagram: what overlaps and what crosses."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import combinations, pairwise

from cspdiag.draw.composition.shapes import POINT
from cspdiag.draw.scene.geometry import Point, Rectangle, around
from cspdiag.draw.scene.scene_geometry import bounds, text_place
from cspdiag.draw.scene.shapes import Box, Ellipse, Group, Item, Line, Scene, Text

_TOLERANCE = 0.01


@dataclass
class Relation:
    """The lines, signs and words of one relation."""

    kind: str
    lines: list[tuple[Point, ...]] = field(default_factory=list)
    signs: list[Rectangle] = field(default_factory=list)
    words: list[Rectangle] = field(default_factory=list)


@dataclass
class Measured:
    """What a diagram consists of, in the order in which it is drawn."""

    shapes: dict[str, Rectangle] = field(default_factory=dict)
    frames: dict[str, Rectangle] = field(default_factory=dict)
    words: list[Rectangle] = field(default_factory=list)
    relations: list[Relation] = field(default_factory=list)


def measured(scene: Scene) -> Measured:
    found = Measured()
    for group in _diagram(scene.items):
        _measure(group.items, found)
    return found


def _diagram(items: tuple[Item, ...]) -> Iterator[Group]:
    for item in items:
        if isinstance(item, Group) and item.kind == "diagram":
            yield item


def _measure(items: tuple[Item, ...], found: Measured) -> None:
    for item in items:
        assert isinstance(item, Group), item
        sort = item.kind.split()[0]
        if sort == "relation":
            relation = Relation(item.kind)
            _relate(item.items, relation)
            found.relations.append(relation)
        elif sort == "group":
            _measure_frame(item, found)
        else:
            assert sort in ("instance", "step", "guard", "exception", "condition"), item.kind
            assert item.id not in found.shapes
            found.shapes[item.id] = _measure_shape(item)


def _measure_frame(frame: Group, found: Measured) -> None:
    boxes = [each.place for each in frame.items if isinstance(each, Box)][: 3 if "replicated" in frame.kind else 1]
    assert frame.id not in found.frames
    found.frames[frame.id] = around(boxes)
    name = []
    for item in frame.items[len(boxes) :]:
        if isinstance(item, Text):
            name.append(text_place(item))
        elif isinstance(item, Line | Box):
            name.append(bounds(item))
        elif isinstance(item, Group) and not item.kind.startswith("badge"):
            _measure((item,), found)
    found.words += name


def _measure_shape(shape: Group) -> Rectangle:
    texts = [text_place(each) for each in shape.items if isinstance(each, Text)]
    place = bounds(Group("", tuple(each for each in shape.items if not isinstance(each, Text | Group))))
    for text in texts:
        assert place.contains(text.grown(-1)), (shape.id, text, place)
    return place


def _relate(items: tuple[Item, ...], relation: Relation) -> None:
    for item in items:
        match item:
            case Group():
                if not item.kind.startswith("badge"):
                    _relate(item.items, relation)
            case Text():
                relation.words.append(text_place(item))
            case Line(closed=False) if item.width < 1.5:
                relation.lines.append(item.points)
            case Line() | Box() | Ellipse():
                relation.signs.append(bounds(item))
            case _:
                raise AssertionError(item)


def faults(scene: Scene) -> list[str]:
    """Everything in a drawing that could confuse a reader; empty for a good drawing."""
    found = measured(scene)
    return [*_overlaps(found), *_badly_framed(found), *_over_shapes(found), *_crossings(found), *_covered_words(found)]


def _overlaps(found: Measured) -> Iterator[str]:
    for (one, first), (other, second) in combinations(found.shapes.items(), 2):
        if first.grown(-_TOLERANCE).overlaps(second):
            yield f"{one} and {other} overlap"
    for (one, first), (other, second) in combinations(found.frames.items(), 2):
        if first.overlaps(second) and not first.contains(second) and not second.contains(first):
            yield f"the frames {one} and {other} overlap"


def _badly_framed(found: Measured) -> Iterator[str]:
    for name, frame in found.frames.items():
        for other, shape in found.shapes.items():
            is_part = other.removeprefix("step-").startswith(f"{name.removeprefix('step-')}.")
            if is_part and not frame.contains(shape):
                yield f"{other} is not in its frame {name}"
            if not is_part and frame.overlaps(shape):
                yield f"{other} is in the frame {name} of others"
        for relation in found.relations:
            for line in relation.lines:
                if len({_is_within(frame, point) for point in line}) > 1:
                    yield f"a line of {relation.kind} crosses the border of {name}"


def _is_within(place: Rectangle, point: Point) -> bool:
    return place.x <= point.x <= place.right and place.y <= point.y <= place.bottom


def _over_shapes(found: Measured) -> Iterator[str]:
    for relation in found.relations:
        for name, shape in found.shapes.items():
            # A line reaches into the notch of a reader and onto the point of a writer.
            core = Rectangle(shape.x + POINT + 1, shape.y + 1, shape.width - 2 * POINT - 2, shape.height - 2)
            for start, end in (piece for line in relation.lines for piece in pairwise(line)):
                if core.overlaps(_room(start, end)):
                    yield f"{relation.kind} runs over {name}"
            for sign in relation.signs:
                if sign.grown(-1).overlaps(shape):
                    yield f"the sign of {relation.kind} covers {name}"


def _room(start: Point, end: Point) -> Rectangle:
    """The area of a vertical piece of line, as thick as it is drawn."""
    assert min(abs(start.x - end.x), abs(start.y - end.y)) < _TOLERANCE, "lines are orthogonal"
    return around([Rectangle(each.x - 0.5, each.y - 0.5, 1, 1) for each in (start, end)])


def _crossings(found: Measured) -> Iterator[str]:
    for one, other in combinations(found.relations, 2):
        for first in (piece for line in one.lines for piece in pairwise(line)):
            for second in (piece for line in other.lines for piece in pairwise(line)):
                if _room(*first).overlaps(_room(*second)):
                    yield f"{one.kind} and {other.kind} cross"


def _covered_words(found: Measured) -> Iterator[str]:
    words = [*found.words, *(place for relation in found.relations for place in relation.words)]
    for first, second in combinations([place.grown(-1) for place in words], 2):
        if first.overlaps(second):
            yield "labels overlap"
    for place in [place.grown(-1) for place in words]:
        for name, shape in found.shapes.items():
            if place.overlaps(shape):
                yield f"a label covers {name}"
        for name, frame in found.frames.items():
            if place.overlaps(frame) and not frame.contains(place):
                yield f"a label covers the border of {name}"
        for relation in found.relations:
            if any(place.overlaps(_room(*piece)) for line in relation.lines for piece in pairwise(line)):
                yield f"a label lies over a line of {relation.kind}"
            if any(place.overlaps(sign.grown(-1)) and not sign.contains(place) for sign in relation.signs):
                yield f"a label lies over the sign of {relation.kind}"
