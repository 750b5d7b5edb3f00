"""The places of the symbols of arrows: at the beginning, or, if arrows of several kinds leave one port together, on
each arrow after it has parted from the others; so, too, if another arrow ends where it begins, which is a mistake.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise

from cspdiag.draw.communication.symbols import Symbol, symbol_of
from cspdiag.draw.elements.diagram import Arrow, End
from cspdiag.draw.layout.graph import Route, Section
from cspdiag.draw.scene.geometry import Point
from cspdiag.draw.scene.outline import ARROW_LENGTH

CORNER = 5.0
"""The radius of the bends of arrows."""
SYMBOL_ROOM = 30.0
"""The length of a straight piece of line that has room for a symbol."""

_Piece = tuple[Point, Point]


def parting(arrows: Iterable[Arrow]) -> Iterator[str]:
    """The keys of the arrows that leave a port together with arrows with other symbols, or where another one ends."""
    arrows = tuple(arrows)
    reached = {sink for arrow in arrows for sink in arrow.sinks if sink.port is not None}
    leaving: dict[End, list[Arrow]] = {}
    for arrow in arrows:
        for source in arrow.sources:
            leaving.setdefault(source, []).append(arrow)
    for source, together in leaving.items():
        if source in reached or len({symbol_of(arrow) for arrow in together}) > 1:
            yield from (arrow.key for arrow in together)


def symbol_pieces(
    routes: Mapping[str, Route], symbols: Mapping[str, Symbol | None]
) -> dict[str, dict[str, set[_Piece]]]:
    """The pieces of line that carry the symbol of each arrow, by the ports at which it begins; None for an arrow
    without a symbol.
    """
    leaving: dict[str, list[str]] = {}
    for arrow, route in routes.items():
        for source in dict.fromkeys(section.source for section in route.sections if section.source is not None):
            leaving.setdefault(source, []).append(arrow)
    reaching: dict[str, list[_Piece]] = {}
    for route in routes.values():
        for section in route.sections:
            if section.target is not None:
                reaching.setdefault(section.target, []).extend(pairwise(section.points))
    found: dict[str, dict[str, set[_Piece]]] = {arrow: {} for arrow in routes}
    for source, arrows in leaving.items():
        for arrow in arrows:
            others = [
                piece
                for other in arrows
                if symbols[other] != symbols[arrow]
                for section in routes[other].sections
                for piece in pairwise(section.points)
            ]
            begun = [section for section in routes[arrow].sections if section.source == source]
            ending = reaching.get(source, [])
            if any(_covered(section.points[0], section.points[1], ending) != section.points[0] for section in begun):
                others += ending
            found[arrow][source] = {piece for section in begun for piece in _pieces(routes[arrow], section, others)}
    return found


def _pieces(route: Route, section: Section, others: Sequence[_Piece]) -> Iterator[_Piece]:
    """The pieces for the symbol of an arrow that begins with a section beside others."""
    if others:
        yield from (_roomy(_alone(path, others)) for path in _paths(route, section))
    else:
        yield section.points[0], section.points[1]


def _paths(route: Route, section: Section, before: tuple[Point, ...] = ()) -> Iterator[tuple[Point, ...]]:
    """All paths from the beginning of a section to the ends of the arrow in that direction."""
    path = (*before, *section.points)
    onward = [each for each in route.sections if each.source is None and each.points[0] == path[-1]]
    if not onward:
        yield path
    for each in onward:
        yield from _paths(route, each, path[:-1])


def _alone(path: Sequence[Point], others: Sequence[_Piece]) -> tuple[Point, ...]:
    """The rest of a path after the part that the others cover from its beginning."""
    for at, (first, second) in enumerate(pairwise(path)):
        reached = _covered(first, second, others)
        if reached != second:
            return (reached, *path[at + 1 :])
    return tuple(path)


def _covered(first: Point, second: Point, others: Sequence[_Piece]) -> Point:
    """How far pieces cover the line from one point to another."""
    reached = first
    while reached != second:
        further = [
            min((end, second), key=lambda point: _length(first, point))
            for piece in others
            for end in piece
            if _between(piece[0], reached, piece[1])
            and (_between(first, end, second) or _between(first, second, end))
            and _length(first, end) > _length(first, reached)
        ]
        if not further:
            break
        reached = max(further, key=lambda point: _length(first, point))
    return reached


def _roomy(path: Sequence[Point]) -> _Piece:
    """The first straight piece with room for a symbol after its bend, a horizontal one if possible; or else the
    longest.
    """
    pieces = list(pairwise(path))
    room = {piece: _length(*piece) - (ARROW_LENGTH if piece == pieces[-1] else 0) for piece in pieces}
    roomy = [piece for piece in pieces if room[piece] >= SYMBOL_ROOM]
    level = [piece for piece in roomy if piece[0].y == piece[1].y]
    first, second = next(iter([*level, *roomy]), max(pieces, key=lambda piece: room[piece]))
    part = CORNER / _length(first, second) if roomy else 0.0
    return first.moved((second.x - first.x) * part, (second.y - first.y) * part), second


def _length(first: Point, second: Point) -> float:
    return abs(first.x - second.x) + abs(first.y - second.y)


def _between(first: Point, middle: Point, last: Point) -> bool:
    """Whether a point is on a vertical or horizontal line."""
    return abs(_length(first, middle) + _length(middle, last) - _length(first, last)) < 0.01 and (
        first.x == last.x or first.y == last.y
    )
