"""Joins polylines that share parts into one line with forks, of which every part is drawn once."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise

from cspdiag.draw.layout.graph import Route, Section
from cspdiag.draw.scene.geometry import Point

_Step = tuple[Point, Point]


def joined(polylines: Sequence[Sequence[Point]], sources: Mapping[Point, str], targets: Mapping[Point, str]) -> Route:
    """The route that consists of the polylines, each at right angles and directed from a source to a target.

    ``sources`` and ``targets`` name what is at the points where the route begins and ends.
    """
    rounded = [[_rounded(point) for point in line] for line in polylines]
    corners = sorted({point for line in rounded for point in line}, key=lambda each: (each.x, each.y))
    steps = list(dict.fromkeys(step for line in rounded for step in _steps(line, corners)))
    known = set()
    kept: list[_Step] = []
    for first, second in steps:
        if (second, first) not in known:
            known.add((first, second))
            kept.append((first, second))
    ends = {_rounded(point) for point in (*sources, *targets)}
    neighbours: dict[Point, set[Point]] = {}
    for first, second in kept:
        neighbours.setdefault(first, set()).add(second)
        neighbours.setdefault(second, set()).add(first)
    forks = {point for point, near in neighbours.items() if len(near) > 2}
    begins = {_rounded(point): name for point, name in sources.items()}
    finishes = {_rounded(point): name for point, name in targets.items()}
    sections = tuple(
        Section(tuple(_straightened(chain)), begins.get(chain[0]), finishes.get(chain[-1]))
        for chain in _chains(kept, forks | ends)
    )
    return Route(sections, tuple(sorted(forks, key=lambda each: (each.x, each.y))))


def _rounded(point: Point) -> Point:
    return Point(round(point.x, 2) + 0.0, round(point.y, 2) + 0.0)


def _steps(line: Sequence[Point], corners: Sequence[Point]) -> Iterable[_Step]:
    """The pieces of a polyline between the corners of all lines that lie on it."""
    for first, second in pairwise(line):
        if first == second:
            continue
        inner = [corner for corner in corners if corner not in (first, second) and _between(first, corner, second)]
        forward = (second.x - first.x) + (second.y - first.y)
        inner.sort(key=lambda corner: corner.x + corner.y, reverse=forward < 0)
        yield from pairwise([first, *inner, second])


def _between(first: Point, middle: Point, last: Point) -> bool:
    if first.x == last.x == middle.x:
        return min(first.y, last.y) <= middle.y <= max(first.y, last.y)
    if first.y == last.y == middle.y:
        return min(first.x, last.x) <= middle.x <= max(first.x, last.x)
    return False


def _chains(steps: Sequence[_Step], stops: set[Point]) -> list[list[Point]]:
    """Chains of steps that follow each other without a stop in between, in the order of their first steps."""
    following: dict[Point, list[Point]] = {}
    for first, second in steps:
        following.setdefault(first, []).append(second)
    reached = {second for _, second in steps}
    starts = [step for step in steps if step[0] in stops or step[0] not in reached]
    chains: list[list[Point]] = []
    used: set[_Step] = set()
    for start in [*starts, *steps]:
        if start in used:
            continue
        used.add(start)
        chain = list(start)
        while chain[-1] not in stops:
            onward = [each for each in following.get(chain[-1], []) if (chain[-1], each) not in used]
            if not onward:
                break
            used.add((chain[-1], onward[0]))
            chain.append(onward[0])
        chains.append(chain)
    return chains


def _straightened(points: Sequence[Point]) -> list[Point]:
    """The same line without the points at which it does not bend."""
    inner = [
        point
        for before, point, after in zip(points, points[1:], points[2:], strict=False)
        if not _between(before, point, after)
    ]
    return [points[0], *inner, points[-1]]
