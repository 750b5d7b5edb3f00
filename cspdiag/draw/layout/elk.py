"""Lays a graph out with ELK's layered algorithm: orthogonal lines, ports on their given sides, in the order of the
text.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, field

from cspdiag.draw.layout import engine, sizes
from cspdiag.draw.layout.elk_graph import (
    LABEL_GAP,
    ElkGraph,
    Json,
    elk_graph,
    least_proportions,
    whole,
    without_text_order,
    wrapped,
)
from cspdiag.draw.layout.graph import Edge, Graph, Label, Layout, LayoutError, Route, Side
from cspdiag.draw.layout.hierarchy import Hierarchy
from cspdiag.draw.layout.joined import joined
from cspdiag.draw.scene.geometry import Point, Rectangle

WIDEST = 2400.0
WIDEST_SHAPE = 6.0
"""A drawing wider than both limits, one in pixels and one as a multiple of its height, is broken into rows; long chains
are.
"""

LARGE = 400
"""Boxes. A smaller graph is always laid out in one row first: that takes less than a second."""


def engine_available() -> bool:
    """Whether a layout engine is installed."""
    return engine.available()


def lay_out(graph: Graph) -> Layout:
    """The layout of a graph. Raises LayoutError if the engine fails, MissingToolError if there is none, and ValueError
    for an invalid graph.
    """
    elk = elk_graph(graph)
    if _is_surely_too_wide(elk):
        # To lay it out in one row takes as long as in several, and would show only that it is too wide.
        with suppress(LayoutError):
            return _layout_of(elk, engine.run(wrapped(elk)))
        elk = elk_graph(graph)
    try:
        placed = engine.run(whole(elk))
    except LayoutError:
        placed = engine.run(without_text_order(elk))
    if not elk.downwards and _is_too_wide(placed["width"], placed["height"]):
        with suppress(LayoutError):
            placed = engine.run(wrapped(elk))
    return _layout_of(elk, placed)


def _is_too_wide(width: float, height: float) -> bool:
    return width > max(WIDEST, WIDEST_SHAPE * height)


def _is_surely_too_wide(elk: ElkGraph) -> bool:
    """Whether a large drawing would be too wide even if it were half as wide and twice as high as is to be expected."""
    if elk.downwards or len(elk.hierarchy.nodes) < LARGE:
        return False
    width, height = least_proportions(elk)
    return _is_too_wide(width / 2, 2 * height)


@dataclass
class _Places:
    """The objects that ELK has placed, by identifier."""

    nodes: dict[str, Rectangle] = field(default_factory=dict)
    ports: dict[str, Point] = field(default_factory=dict)
    edges: list[Json] = field(default_factory=list)


def _layout_of(elk: ElkGraph, placed: Json) -> Layout:
    places = _Places()
    _collect(placed, places)
    hierarchy = elk.hierarchy
    sides = {
        port: hierarchy.ports[port].side or _side(places.ports[port], places.nodes[owner])
        for port, owner in hierarchy.owners.items()
        if port in hierarchy.ports
    }
    labels = _box_labels(hierarchy, places, sides)
    lines: dict[str, list[list[Point]]] = {edge.id: [] for edge in hierarchy.edges}
    for part in places.edges:
        lines[elk.parts[part["id"]]] += [_points(section) for section in part.get("sections", [])]
        for label in part.get("labels", []):
            labels[label["id"]] = _label_place(elk.labels[label["id"]], _rectangle(label))
    routes: dict[str, Route] = {}
    for edge in hierarchy.edges:
        if joint := elk.joints.get(edge.id):
            lines[edge.id].append([places.ports[joint.entry], places.ports[joint.exit]])
            if edge.label is not None:
                labels[edge.label.id] = _joint_label(edge.label, places.nodes[joint.node], elk.downwards)
        routes[edge.id] = _route(elk, edge, lines[edge.id], places)
    return Layout(
        width=placed["width"],
        height=placed["height"],
        nodes={name: places.nodes[name] for name in hierarchy.nodes},
        ports={name: places.ports[name] for name in hierarchy.ports},
        sides=sides,
        labels=labels,
        routes=routes,
    )


def _collect(parent: Json, places: _Places) -> None:
    places.edges += parent.get("edges", [])
    for node in parent.get("children", []):
        places.nodes[node["id"]] = _rectangle(node)
        for port in node.get("ports", []):
            places.ports[port["id"]] = _point(port)
        _collect(node, places)


def _rectangle(made: Json) -> Rectangle:
    return Rectangle(made["x"], made["y"], made["width"], made["height"])


def _points(section: Json) -> list[Point]:
    return [_point(each) for each in (section["startPoint"], *section.get("bendPoints", []), section["endPoint"])]


def _point(made: Json) -> Point:
    # Sums of fractions that differ in their last bits are the same place.
    return Point(round(made["x"], 2) + 0.0, round(made["y"], 2) + 0.0)


def _side(at: Point, place: Rectangle) -> Side:
    distances = {
        Side.WEST: abs(at.x - place.x),
        Side.EAST: abs(at.x - place.right),
        Side.NORTH: abs(at.y - place.y),
        Side.SOUTH: abs(at.y - place.bottom),
    }
    return min(distances, key=lambda side: distances[side])


def _box_labels(hierarchy: Hierarchy, places: _Places, sides: dict[str, Side]) -> dict[str, Rectangle]:
    labels: dict[str, Rectangle] = {}
    for name, node in hierarchy.nodes.items():
        if node.title and (title := sizes.title_place(node, places.nodes[name])):
            labels[node.title.id] = title
        for port in node.ports:
            place = sizes.port_label_place(node, port, places.ports[port.id], sides[port.id])
            if port.label and place:
                labels[port.label.id] = place
    return labels


def _joint_label(label: Label, joint: Rectangle, downwards: bool) -> Rectangle:
    if downwards:
        return Rectangle(joint.x + LABEL_GAP, joint.centre.y - label.height / 2, label.width, label.height)
    return _label_place(label, Rectangle(joint.x, joint.y, joint.width, joint.height - LABEL_GAP))


def _label_place(label: Label, room: Rectangle) -> Rectangle:
    """The label in the middle of its room, standing on its lower side."""
    return Rectangle(room.centre.x - label.width / 2, room.bottom - label.height, label.width, label.height)


def _route(elk: ElkGraph, edge: Edge, lines: list[list[Point]], places: _Places) -> Route:
    """Identify the ends of the lines by their places: the ends of an edge are at different places."""
    joint = elk.joints.get(edge.id)
    inner = {places.ports[joint.entry], places.ports[joint.exit]} if joint else set()
    begins = {point for line in lines if (point := line[0]) not in inner}
    finishes = {point for line in lines if (point := line[-1]) not in inner}
    sources = {point: _nearest(elk, edge.sources, point, places) for point in begins}
    targets = {point: _nearest(elk, edge.targets, point, places) for point in finishes}
    return joined(lines, sources, targets)


def _nearest(elk: ElkGraph, ends: tuple[str, ...], point: Point, places: _Places) -> str:
    def distance(end: str) -> float:
        if end in places.ports:
            place = places.ports[end]
            return abs(place.x - point.x) + abs(place.y - point.y)
        box = places.nodes[end]
        nearest_x, nearest_y = min(max(point.x, box.x), box.right), min(max(point.y, box.y), box.bottom)
        return abs(nearest_x - point.x) + abs(nearest_y - point.y)

    return min(ends, key=distance)
