"""Measures, moves and joins what is drawn."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from math import ceil

from cspdiag.base.record import replaced
from cspdiag.draw.scene.geometry import Point, Rectangle, around
from cspdiag.draw.scene.shapes import (
    Anchor,
    Box,
    Close,
    Command,
    CubicTo,
    Curve,
    Ellipse,
    Group,
    Item,
    Line,
    LineTo,
    MoveTo,
    Scene,
    Text,
)
from cspdiag.draw.scene.text_metrics import ASCENT, DESCENT, runs_width

MARGIN = 24.0
"""The margin around a drawing, in pixels."""


def text_place(text: Text) -> Rectangle:
    """The room that a text takes, from its tallest to its lowest possible character."""
    width = runs_width(text.runs, text.size)
    match text.anchor:
        case Anchor.START:
            left = text.at.x
        case Anchor.MIDDLE:
            left = text.at.x - width / 2
        case Anchor.END:
            left = text.at.x - width
    return Rectangle(left, text.at.y - ASCENT * text.size, width, (ASCENT + DESCENT) * text.size)


def bounds(item: Item) -> Rectangle:
    """The smallest rectangle around an item; raises ValueError for an empty group."""
    match item:
        case Box() | Ellipse():
            return item.place
        case Text():
            return text_place(item)
        case Line():
            return _around_points(item.points)
        case Curve():
            return _around_points([point for command in item.commands for point in _points(command)])
        case Group():
            return around([bounds(each) for each in item.items if not _is_empty(each)])


def _is_empty(item: Item) -> bool:
    return isinstance(item, Group) and all(_is_empty(each) for each in item.items)


def _around_points(points: Sequence[Point]) -> Rectangle:
    left, top = min(each.x for each in points), min(each.y for each in points)
    return Rectangle(left, top, max(each.x for each in points) - left, max(each.y for each in points) - top)


def _points(command: Command) -> tuple[Point, ...]:
    match command:
        case MoveTo() | LineTo():
            return (command.to,)
        case CubicTo():
            return (command.first, command.second, command.to)
        case Close():
            return ()


def moved(item: Item, dx: float, dy: float) -> Item:
    """The same item, ``dx`` to the right and ``dy`` below."""
    match item:
        case Box() | Ellipse():
            return replaced(item, place=item.place.moved(dx, dy))
        case Text():
            return replaced(item, at=item.at.moved(dx, dy))
        case Line():
            return replaced(item, points=tuple(point.moved(dx, dy) for point in item.points))
        case Curve():
            return replaced(item, commands=tuple(_moved_command(command, dx, dy) for command in item.commands))
        case Group():
            return replaced(item, items=tuple(moved(each, dx, dy) for each in item.items))


def _moved_command(command: Command, dx: float, dy: float) -> Command:
    match command:
        case MoveTo() | LineTo():
            return replaced(command, to=command.to.moved(dx, dy))
        case CubicTo():
            return CubicTo(command.first.moved(dx, dy), command.second.moved(dx, dy), command.to.moved(dx, dy))
        case Close():
            return command


def fitted(
    items: Iterable[Item], *, margin: float = MARGIN, title: str = "", description: str = "", name: str = ""
) -> Scene:
    """A scene just large enough for the items, with a margin around them."""
    kept = tuple(each for each in items if not _is_empty(each))
    if not kept:
        return Scene(2 * margin, 2 * margin, (), title, description, name)
    room = around([bounds(each) for each in kept])
    placed = tuple(moved(each, margin - room.x, margin - room.y) for each in kept)
    return Scene(ceil(room.width + 2 * margin), ceil(room.height + 2 * margin), placed, title, description, name)


def below_each_other(parts: Iterable[Item], gap: float) -> list[Item]:
    """The parts from top to bottom, each at the left border, with ``gap`` between them."""
    placed: list[Item] = []
    y = 0.0
    for part in parts:
        room = bounds(part)
        placed.append(moved(part, -room.x, y - room.y))
        y += room.height + gap
    return placed


def stacked(scenes: Sequence[Scene], *, gap: float = 0) -> Scene:
    """One scene with the others below each other; names and descriptions are those of the first."""
    return _joined(scenes, lambda done, _: (0, done.height + gap if done.items else 0))


def beside(scenes: Sequence[Scene], *, gap: float = 0) -> Scene:
    """One scene with the others from left to right; names and descriptions are those of the first."""
    return _joined(scenes, lambda done, _: (done.width + gap if done.items else 0, 0))


def _joined(scenes: Sequence[Scene], place: Callable[[Scene, Scene], tuple[float, float]]) -> Scene:
    done = replaced(scenes[0], items=(), width=0, height=0)
    for scene in scenes:
        dx, dy = place(done, scene)
        done = replaced(
            done,
            items=(*done.items, *(moved(each, dx, dy) for each in scene.items)),
            width=max(done.width, dx + scene.width),
            height=max(done.height, dy + scene.height),
        )
    return done


def every(items: Iterable[Item]) -> Iterator[Item]:
    """The items and everything in their groups, in the order in which they are drawn."""
    for item in items:
        yield item
        if isinstance(item, Group):
            yield from every(item.items)
