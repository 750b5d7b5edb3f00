"""Lays a graph out with ELK's layered algorithm: orthogonal lines, ports on the sides they were given, the order of the text kept.

ELK knows lines with two ends. A line with more ends that carries a label is given to it as a node of the label's size, its joint, with a line to
every end; without a label, and with one end on one side, as lines that share a port, which ELK draws over each other as far as it can.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from cspdiag.draw.geometry import Point, Rectangle
from cspdiag.draw.layout import engine, sizes
from cspdiag.draw.layout.graph import (
    Direction,
    Edge,
    Graph,
    Label,
    Layer,
    Layout,
    LayoutError,
    Node,
    PortOrder,
    Route,
    Side,
)
from cspdiag.draw.layout.hierarchy import Hierarchy, hierarchy
from cspdiag.draw.layout.joined import joined

_Json = dict[str, Any]

PORT_RISE = 10.0
"""How far the first port may come up to the title: ELK leaves the distance of two ports above it."""

LABEL_GAP = 3.0
"""Between a line and its label."""

HEADROOM = 3.0
"""What the tallest letters leave free of a label's height, so that labelled lines can be as close as ports."""

JOINT_GAP = 8.0
"""Between a label on a forked line and what is above or below it."""

_OPTIONS = {
    "elk.algorithm": "layered",
    "elk.hierarchyHandling": "SEPARATE_CHILDREN",
    "elk.edgeRouting": "ORTHOGONAL",
    "elk.json.shapeCoords": "ROOT",
    "elk.json.edgeCoords": "ROOT",
    "elk.randomSeed": "1",
    "elk.padding": "[top=0,left=0,bottom=0,right=0]",
    "elk.layered.considerModelOrder.strategy": "PREFER_EDGES",
    "elk.layered.cycleBreaking.strategy": "GREEDY_MODEL_ORDER",
    "elk.layered.nodePlacement.strategy": "BRANDES_KOEPF",
    "elk.layered.edgeLabels.sideSelection": "ALWAYS_UP",
    "elk.layered.edgeLabels.centerLabelPlacementStrategy": "MEDIAN_LAYER",
    "elk.spacing.edgeNode": "16",
    "elk.spacing.edgeEdge": "9",
    "elk.spacing.edgeLabel": str(LABEL_GAP),
    "elk.spacing.componentComponent": "40",
    "elk.layered.spacing.edgeNodeBetweenLayers": "20",
    "elk.layered.spacing.edgeEdgeBetweenLayers": "12",
    "elk.layered.unnecessaryBendpoints": "false",
}

_TEXT_ORDER = {"elk.layered.crossingMinimization.forceNodeModelOrder": "true"}
"""Keeps the order of the text within a layer. ELK fails on it on some graphs, which are laid out without."""


@dataclass
class _Joint:
    """The stand-in for a line of several ends: its node, and the ports where lines enter and leave it."""

    node: str
    entry: str
    exit: str


@dataclass
class _Question:
    """The graph in ELK's format while it is made, and which lines in it are which."""

    graph: Graph
    hierarchy: Hierarchy
    nodes: dict[str, _Json] = field(default_factory=dict)
    top: list[_Json] = field(default_factory=list)
    edges: list[_Json] = field(default_factory=list)
    parts: dict[str, str] = field(default_factory=dict)
    """The edge of each line in ELK's graph."""
    joints: dict[str, _Joint] = field(default_factory=dict)
    labels: dict[str, Label] = field(default_factory=dict)
    """The labels that ELK places."""

    @property
    def downwards(self) -> bool:
        return self.graph.direction is Direction.DOWN


def engine_available() -> bool:
    """Whether anything can be laid out here."""
    return engine.available()


def lay_out(graph: Graph) -> Layout:
    """Where everything goes.

    Raises LayoutError where the engine fails, MissingToolError where there is none, and ValueError for a graph that is not one.
    """
    question = _Question(graph, hierarchy(graph))
    question.top = [_node(question, node) for node in graph.nodes]
    for edge in question.hierarchy.edges:
        _add_edge(question, edge)
    options = _inner_options(graph) | {"elk.layered.thoroughness": str(_thoroughness(question))}
    asked = {"id": "", "layoutOptions": options, "children": question.top, "edges": question.edges}
    try:
        placed = engine.run(asked | {"layoutOptions": options | _TEXT_ORDER})
    except LayoutError:
        for node in question.nodes.values():
            for option in (*_TEXT_ORDER, "elk.layered.considerModelOrder.strategy"):
                node["layoutOptions"].pop(option, None)
        placed = engine.run(asked)
    return _answer(question, placed)


def _inner_options(graph: Graph) -> dict[str, str]:
    return _OPTIONS | {
        "elk.direction": graph.direction.value,
        "elk.spacing.nodeNode": str(graph.node_spacing),
        "elk.layered.spacing.nodeNodeBetweenLayers": str(graph.layer_spacing),
    }


def _thoroughness(question: _Question) -> int:
    """How often ELK looks for fewer crossings; in a large graph each time takes long and gains little."""
    return max(1, min(7, 300 // (len(question.nodes) + len(question.parts) + 1)))


def _node(question: _Question, node: Node) -> _Json:
    width, height = sizes.least_size(node)
    top = sizes.title_height(node)
    options = {
        "elk.nodeSize.constraints": "[PORTS, MINIMUM_SIZE]" if node.title else "[MINIMUM_SIZE]",
        "elk.nodeSize.minimum": f"({width},{height})",
        "elk.portConstraints": node.port_order.value,
        "elk.layered.layering.layerConstraint": _layer(question, node).value,
    }
    spacings = {
        "elk.spacing.portPort": str(sizes.port_spacing(node)),
        "elk.spacing.portsSurrounding": f"[top={max(top - PORT_RISE, 0)},left=0,bottom=0,right=0]",
    }
    if node.layer is not Layer.ANY:
        spacings["elk.spacing.nodeNode"] = str(max(sizes.PORT_SPACING - height, 2))
    made: _Json = {"id": node.id, "layoutOptions": options, "individualSpacings": spacings, "ports": _ports(node)}
    if node.children:
        padding = sizes.children_padding(node)
        # What a graph is told does not hold for the graphs inside its nodes.
        options |= (
            _inner_options(question.graph) | _TEXT_ORDER | {"elk.spacing.portPort": str(sizes.port_spacing(node))}
        )
        options["elk.padding"] = (
            f"[top={padding.top},left={padding.left},bottom={padding.bottom},right={padding.right}]"
        )
        made["children"] = [_node(question, child) for child in node.children]
    else:
        made["width"], made["height"] = width, height
    question.nodes[node.id] = made
    return made


def _layer(question: _Question, node: Node) -> Layer:
    """The layer a node asked for; a node with lines to its wrong side cannot have it."""
    own = {node.id, *(port.id for port in node.ports)}
    edges = question.hierarchy.edges
    if node.layer is Layer.FIRST and any(own & {*edge.targets} for edge in edges):
        return Layer.ANY
    if node.layer is Layer.LAST and any(own & {*edge.sources} for edge in edges):
        return Layer.ANY
    return node.layer


def _ports(node: Node) -> list[_Json]:
    # ELK counts ports clockwise from the upper left corner.
    by_side = {side: [port for port in node.ports if port.side is side] for side in (*Side, None)}
    clockwise = [
        *by_side[Side.NORTH],
        *by_side[Side.EAST],
        *reversed(by_side[Side.SOUTH]),
        *reversed(by_side[Side.WEST]),
        *by_side[None],
    ]
    index = {port.id: place for place, port in enumerate(clockwise)}
    ports: list[_Json] = []
    for port in node.ports:
        options = {"elk.port.index": str(index[port.id])} if node.port_order is PortOrder.FIXED_ORDER else {}
        if port.side is not None:
            options["elk.port.side"] = port.side.value
        ports.append({"id": port.id, "width": 0, "height": 0, "layoutOptions": options})
    return ports


def _add_edge(question: _Question, edge: Edge) -> None:
    if len(edge.sources) == len(edge.targets) == 1:
        _add_part(question, edge, edge.sources[0], edge.targets[0], edge.label)
    elif edge.label is None and 1 in (len(edge.sources), len(edge.targets)):
        sources = [_end(question, edge, end, leaves=True) for end in edge.sources]
        targets = [_end(question, edge, end, leaves=False) for end in edge.targets]
        for source in sources:
            for target in targets:
                _add_part(question, edge, source, target)
    else:
        joint = _add_joint(question, edge)
        for source in edge.sources:
            _add_part(question, edge, _end(question, edge, source, leaves=True), joint.entry)
        for target in edge.targets:
            _add_part(question, edge, joint.exit, _end(question, edge, target, leaves=False))


def _add_part(question: _Question, edge: Edge, source: str, target: str, label: Label | None = None) -> None:
    name = f"{edge.id}#{len(question.parts)}"
    question.parts[name] = edge.id
    made: _Json = {"id": name, "sources": [source], "targets": [target]}
    if edge.priority:
        made["layoutOptions"] = {
            f"elk.layered.priority.{aim}": str(edge.priority) for aim in ("straightness", "shortness")
        }
    if label is not None:
        question.labels[label.id] = label
        made["labels"] = [
            {
                "id": label.id,
                "text": " ",
                "width": sizes.even(label.width),
                "height": _label_height(label),
                "layoutOptions": {"elk.edgeLabels.placement": "CENTER"},
            }
        ]
    room = question.hierarchy.room_of(edge)
    siblings: list[_Json] = question.edges if room is None else question.nodes[room].setdefault("edges", [])
    siblings.append(made)


def _end(question: _Question, edge: Edge, end: str, *, leaves: bool) -> str:
    """The port where a line of several ends meets a node; made where the edge names the node itself."""
    if end in question.hierarchy.ports:
        return end
    name = f"{edge.id}@{end}"
    sides = (Side.SOUTH, Side.NORTH) if question.downwards else (Side.EAST, Side.WEST)
    side = sides[0 if leaves else 1]
    ports: list[_Json] = question.nodes[end]["ports"]
    if all(port["id"] != name for port in ports):
        ports.append({"id": name, "width": 0, "height": 0, "layoutOptions": {"elk.port.side": side.value}})
    return name


def _add_joint(question: _Question, edge: Edge) -> _Joint:
    joint = _Joint(f"{edge.id}&", f"{edge.id}&<", f"{edge.id}&>")
    width = sizes.even(edge.label.width) if edge.label else 0
    height = _label_height(edge.label) if edge.label else 0
    if question.downwards:
        width, ends = width + LABEL_GAP, ((0.0, 0.0, Side.NORTH), (0.0, height, Side.SOUTH))
    else:
        height += LABEL_GAP
        ends = ((0.0, height, Side.WEST), (width, height, Side.EAST))
    made: _Json = {
        "id": joint.node,
        "width": width,
        "height": height,
        "layoutOptions": {"elk.portConstraints": "FIXED_POS"},
        "individualSpacings": {"elk.spacing.nodeNode": str(JOINT_GAP), "elk.spacing.edgeNode": str(JOINT_GAP)},
        "ports": [
            {"id": name, "x": x, "y": y, "width": 0, "height": 0, "layoutOptions": {"elk.port.side": side.value}}
            for name, (x, y, side) in zip((joint.entry, joint.exit), ends, strict=True)
        ],
    }
    room = question.hierarchy.room_of(edge)
    siblings: list[_Json] = question.top if room is None else question.nodes[room].setdefault("children", [])
    siblings.append(made)
    question.joints[edge.id] = joint
    return joint


@dataclass
class _Places:
    """What ELK has placed, by identifier."""

    nodes: dict[str, Rectangle] = field(default_factory=dict)
    ports: dict[str, Point] = field(default_factory=dict)
    edges: list[_Json] = field(default_factory=list)


def _answer(question: _Question, placed: _Json) -> Layout:
    places = _Places()
    _collect(placed, places)
    hierarchy = question.hierarchy
    sides = {
        port: hierarchy.ports[port].side or _side(places.ports[port], places.nodes[owner])
        for port, owner in hierarchy.owners.items()
        if port in hierarchy.ports
    }
    labels = _box_labels(hierarchy, places, sides)
    lines: dict[str, list[list[Point]]] = {edge.id: [] for edge in hierarchy.edges}
    for part in places.edges:
        lines[question.parts[part["id"]]] += [_points(section) for section in part.get("sections", [])]
        for label in part.get("labels", []):
            labels[label["id"]] = _label_place(question.labels[label["id"]], _rectangle(label))
    routes: dict[str, Route] = {}
    for edge in hierarchy.edges:
        if joint := question.joints.get(edge.id):
            lines[edge.id].append([places.ports[joint.entry], places.ports[joint.exit]])
            if edge.label is not None:
                labels[edge.label.id] = _joint_label(edge.label, places.nodes[joint.node], question.downwards)
        routes[edge.id] = _route(question, edge, lines[edge.id], places)
    return Layout(
        width=placed["width"],
        height=placed["height"],
        nodes={name: places.nodes[name] for name in hierarchy.nodes},
        ports={name: places.ports[name] for name in hierarchy.ports},
        sides=sides,
        labels=labels,
        routes=routes,
    )


def _collect(parent: _Json, places: _Places) -> None:
    places.edges += parent.get("edges", [])
    for node in parent.get("children", []):
        places.nodes[node["id"]] = _rectangle(node)
        for port in node.get("ports", []):
            places.ports[port["id"]] = _point(port)
        _collect(node, places)


def _rectangle(made: _Json) -> Rectangle:
    return Rectangle(made["x"], made["y"], made["width"], made["height"])


def _points(section: _Json) -> list[Point]:
    return [_point(each) for each in (section["startPoint"], *section.get("bendPoints", []), section["endPoint"])]


def _point(made: _Json) -> Point:
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


def _label_height(label: Label) -> float:
    return max(round(label.height - HEADROOM), 0)


def _route(question: _Question, edge: Edge, lines: list[list[Point]], places: _Places) -> Route:
    """Names the ends of the lines by where they are: the ends of an edge are different places."""
    joint = question.joints.get(edge.id)
    inner = {places.ports[joint.entry], places.ports[joint.exit]} if joint else set()
    begins = {point for line in lines if (point := line[0]) not in inner}
    finishes = {point for line in lines if (point := line[-1]) not in inner}
    sources = {point: _nearest(question, edge.sources, point, places) for point in begins}
    targets = {point: _nearest(question, edge.targets, point, places) for point in finishes}
    return joined(lines, sources, targets)


def _nearest(question: _Question, ends: tuple[str, ...], point: Point, places: _Places) -> str:
    def distance(end: str) -> float:
        if end in places.ports:
            place = places.ports[end]
            return abs(place.x - point.x) + abs(place.y - point.y)
        box = places.nodes[end]
        nearest_x, nearest_y = min(max(point.x, box.x), box.right), min(max(point.y, box.y), box.bottom)
        return abs(nearest_x - point.x) + abs(nearest_y - point.y)

    return min(ends, key=distance)
