"""Graphs in ELK's JSON format.

ELK only has lines with two ends. A line with more ends that carries a label is passed to it as a node of the label's
size, its joint, with a line to every end; without a label, and with one end on one side, as lines that share a port,
which ELK draws over each other as far as it can.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from cspdiag.draw.layout import sizes
from cspdiag.draw.layout.graph import Direction, Edge, Graph, Label, Layer, Node, PortOrder, Side
from cspdiag.draw.layout.hierarchy import Hierarchy, hierarchy

Json = dict[str, Any]

PORT_RISE = 10.0
"""How close the first port may be to the title: ELK leaves the distance of two ports above it."""

LABEL_GAP = 3.0
"""Between a line and its label."""

HEADROOM = 3.0
"""The part of a label's height that the tallest letters leave free, so labelled lines can be as close as ports."""

JOINT_GAP = 8.0
"""Between a label on a forked line and anything above or below it."""

BOX_GAP = 16.0
"""Between a box and a line that passes it."""

_OPTIONS = {
    "elk.algorithm": "layered",
    "elk.hierarchyHandling": "SEPARATE_CHILDREN",
    "elk.edgeRouting": "ORTHOGONAL",
    "elk.json.shapeCoords": "ROOT",
    "elk.json.edgeCoords": "ROOT",
    "elk.randomSeed": "1",
    "elk.padding": "[top=0,left=0,bottom=0,right=0]",
    "elk.layered.considerModelOrder.components": "MODEL_ORDER",
    "elk.layered.considerModelOrder.strategy": "PREFER_EDGES",
    "elk.layered.cycleBreaking.strategy": "GREEDY_MODEL_ORDER",
    "elk.layered.nodePlacement.strategy": "BRANDES_KOEPF",
    "elk.layered.nodePlacement.bk.fixedAlignment": "RIGHTDOWN",
    "elk.layered.edgeLabels.sideSelection": "ALWAYS_UP",
    "elk.layered.edgeLabels.centerLabelPlacementStrategy": "MEDIAN_LAYER",
    "elk.spacing.edgeNode": str(JOINT_GAP),
    "elk.spacing.edgeEdge": "9",
    "elk.spacing.edgeLabel": str(LABEL_GAP),
    "elk.spacing.componentComponent": "28",
    "elk.spacing.nodeSelfLoop": str(BOX_GAP),
    "elk.layered.spacing.edgeNodeBetweenLayers": "20",
    "elk.layered.spacing.edgeEdgeBetweenLayers": "12",
    "elk.layered.unnecessaryBendpoints": "false",
}

TEXT_ORDER = {"elk.layered.crossingMinimization.forceNodeModelOrder": "true"}
"""Keeps the order of the text within a layer. ELK fails on it on some graphs, which are laid out without."""


@dataclass
class Joint:
    """The stand-in for a line of several ends: its node, and the ports where lines enter and leave it."""

    node: str
    entry: str
    exit: str


@dataclass
class ElkGraph:
    """A graph in ELK's format, and the meaning of its identifiers."""

    graph: Graph
    hierarchy: Hierarchy
    nodes: dict[str, Json] = field(default_factory=dict)
    top: list[Json] = field(default_factory=list)
    edges: list[Json] = field(default_factory=list)
    parts: dict[str, str] = field(default_factory=dict)
    """The edge of each line in ELK's graph."""
    joints: dict[str, Joint] = field(default_factory=dict)
    labels: dict[str, Label] = field(default_factory=dict)
    """The labels that ELK places."""
    options: dict[str, str] = field(default_factory=dict)

    @property
    def downwards(self) -> bool:
        """Whether most lines lead down."""
        return self.graph.direction is Direction.DOWN


def elk_graph(graph: Graph) -> ElkGraph:
    """A graph in ELK's format. Raises ValueError for an invalid graph."""
    made = ElkGraph(graph, hierarchy(graph))
    made.top = [_node(made, node) for node in graph.nodes]
    for edge in made.hierarchy.edges:
        _add_edge(made, edge)
    made.options = _options(made)
    return made


def _options(elk: ElkGraph) -> dict[str, str]:
    graph = elk.graph
    return _OPTIONS | {
        **TEXT_ORDER,
        "elk.direction": graph.direction.value,
        "elk.layered.thoroughness": str(_thoroughness(elk)),
        "elk.spacing.nodeNode": str(graph.node_spacing),
        "elk.layered.spacing.nodeNodeBetweenLayers": str(graph.layer_spacing),
    }


def without_text_order(elk: ElkGraph) -> Json:
    """The input for ELK, without the options on which it may fail."""
    for options in (elk.options, *(node["layoutOptions"] for node in elk.nodes.values())):
        for option in (*TEXT_ORDER, "elk.layered.considerModelOrder.strategy"):
            options.pop(option, None)
    return whole(elk)


def wrapped(elk: ElkGraph) -> Json:
    """The input for ELK, with options to break it into rows."""
    elk.options |= {"elk.layered.wrapping.strategy": "MULTI_EDGE", "elk.aspectRatio": "1.8"}
    return whole(elk)


def least_proportions(elk: ElkGraph) -> tuple[float, float]:
    """The width and the height that a drawing to the right needs for the boxes of its layers alone: a box is in the
    layer after all those before it in the text that a line joins to it.
    """
    place = {node.id: number for number, node in enumerate(elk.graph.nodes)}
    before: dict[str, list[str]] = {}
    for edge in elk.graph.edges:
        for source in edge.sources:
            for target in edge.targets:
                ends = (elk.hierarchy.chains[elk.hierarchy.owners[end]][0] for end in (source, target))
                first, second = sorted(ends, key=place.__getitem__)
                before.setdefault(second, []).append(first)
    layer: dict[str, int] = {}
    widths: dict[int, float] = {}
    heights: dict[int, float] = {}
    for node in elk.graph.nodes:
        number = layer[node.id] = max((layer[one] + 1 for one in before.get(node.id, ()) if one in layer), default=0)
        ports = len(node.ports) * sizes.port_spacing(node)
        widths[number] = max(widths.get(number, 0), node.width)
        heights[number] = heights.get(number, 0) + max(node.height, ports) + elk.graph.node_spacing
    return sum(widths.values()) + len(widths) * elk.graph.layer_spacing, max(heights.values(), default=0)


def whole(elk: ElkGraph) -> Json:
    """The input for ELK."""
    return {"id": "", "layoutOptions": elk.options, "children": elk.top, "edges": elk.edges}


def _thoroughness(elk: ElkGraph) -> int:
    """How often ELK looks for fewer crossings; in a large graph each time takes long and gains little."""
    parts = len(elk.hierarchy.nodes) + len(elk.hierarchy.edges)
    return max(1, min(7, 300 // (parts + 1)))


def _node(elk: ElkGraph, node: Node) -> Json:
    width, height = sizes.least_size(node)
    top = sizes.title_height(node)
    options = {
        "elk.nodeSize.constraints": "[PORTS, MINIMUM_SIZE]" if node.title else "[MINIMUM_SIZE]",
        "elk.nodeSize.minimum": f"({width},{height})",
        "elk.portConstraints": node.port_order.value,
        "elk.layered.layering.layerConstraint": _layer(elk, node).value,
    }
    spacings = {
        "elk.spacing.edgeNode": str(BOX_GAP),
        "elk.spacing.portPort": str(sizes.port_spacing(node)),
        "elk.spacing.portsSurrounding": f"[top={max(top - PORT_RISE, 0)},left=0,bottom=0,right=0]",
    }
    if node.layer is not Layer.ANY:
        spacings["elk.spacing.nodeNode"] = str(max(sizes.PORT_SPACING - height, 2))
    made: Json = {"id": node.id, "layoutOptions": options, "individualSpacings": spacings, "ports": _ports(node)}
    if node.children:
        padding = sizes.children_padding(node)
        # Options of a graph do not apply to the graphs inside its nodes.
        options |= _options(elk) | {"elk.spacing.portPort": str(sizes.port_spacing(node))}
        options["elk.padding"] = (
            f"[top={padding.top},left={padding.left},bottom={padding.bottom},right={padding.right}]"
        )
        made["children"] = [_node(elk, child) for child in node.children]
    else:
        made["width"], made["height"] = width, height
    elk.nodes[node.id] = made
    return made


def _layer(elk: ElkGraph, node: Node) -> Layer:
    """The requested layer of a node; a node with lines to its wrong side cannot be there."""
    own = {node.id, *(port.id for port in node.ports)}
    edges = elk.hierarchy.edges
    if node.layer is Layer.FIRST and any(own & {*edge.targets} for edge in edges):
        return Layer.ANY
    if node.layer is Layer.LAST and any(own & {*edge.sources} for edge in edges):
        return Layer.ANY
    return node.layer


def _ports(node: Node) -> list[Json]:
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
    ports: list[Json] = []
    for port in node.ports:
        options = {"elk.port.index": str(index[port.id])} if node.port_order is PortOrder.FIXED_ORDER else {}
        if port.side is not None:
            options["elk.port.side"] = port.side.value
        ports.append({"id": port.id, "width": 0, "height": 0, "layoutOptions": options})
    return ports


def _add_edge(elk: ElkGraph, edge: Edge) -> None:
    if len(edge.sources) == len(edge.targets) == 1:
        _add_part(elk, edge, edge.sources[0], edge.targets[0], edge.label)
    elif edge.label is None and 1 in (len(edge.sources), len(edge.targets)):
        sources = [_end(elk, edge, end, leaves=True) for end in edge.sources]
        targets = [_end(elk, edge, end, leaves=False) for end in edge.targets]
        for source in sources:
            for target in targets:
                _add_part(elk, edge, source, target)
    else:
        joint = _add_joint(elk, edge)
        for source in edge.sources:
            _add_part(elk, edge, _end(elk, edge, source, leaves=True), joint.entry)
        for target in edge.targets:
            _add_part(elk, edge, joint.exit, _end(elk, edge, target, leaves=False))


def _add_part(elk: ElkGraph, edge: Edge, source: str, target: str, label: Label | None = None) -> None:
    name = f"{edge.id}#{len(elk.parts)}"
    elk.parts[name] = edge.id
    made: Json = {"id": name, "sources": [source], "targets": [target]}
    if edge.priority:
        made["layoutOptions"] = {
            f"elk.layered.priority.{aim}": str(edge.priority) for aim in ("straightness", "shortness")
        }
    if label is not None:
        elk.labels[label.id] = label
        made["labels"] = [
            {
                "id": label.id,
                "text": " ",
                "width": sizes.even(label.width),
                "height": label_height(label),
                "layoutOptions": {"elk.edgeLabels.placement": "CENTER"},
            }
        ]
    room = elk.hierarchy.room_of(edge)
    siblings: list[Json] = elk.edges if room is None else elk.nodes[room].setdefault("edges", [])
    siblings.append(made)


def _end(elk: ElkGraph, edge: Edge, end: str, *, leaves: bool) -> str:
    """The port where a line of several ends meets a node; made where the edge names the node itself."""
    if end in elk.hierarchy.ports:
        return end
    name = f"{edge.id}@{end}"
    sides = (Side.SOUTH, Side.NORTH) if elk.downwards else (Side.EAST, Side.WEST)
    side = sides[0 if leaves else 1]
    ports: list[Json] = elk.nodes[end]["ports"]
    if all(port["id"] != name for port in ports):
        ports.append({"id": name, "width": 0, "height": 0, "layoutOptions": {"elk.port.side": side.value}})
    return name


def _add_joint(elk: ElkGraph, edge: Edge) -> Joint:
    joint = Joint(f"{edge.id}&", f"{edge.id}&<", f"{edge.id}&>")
    width = sizes.even(edge.label.width) if edge.label else 0
    height = label_height(edge.label) if edge.label else 0
    if elk.downwards:
        width, ends = width + LABEL_GAP, ((0.0, 0.0, Side.NORTH), (0.0, height, Side.SOUTH))
    else:
        height += LABEL_GAP
        ends = ((0.0, height, Side.WEST), (width, height, Side.EAST))
    made: Json = {
        "id": joint.node,
        "width": width,
        "height": height,
        "layoutOptions": {"elk.portConstraints": "FIXED_POS"},
        "individualSpacings": {"elk.spacing.nodeNode": str(JOINT_GAP)},
        "ports": [
            {"id": name, "x": x, "y": y, "width": 0, "height": 0, "layoutOptions": {"elk.port.side": side.value}}
            for name, (x, y, side) in zip((joint.entry, joint.exit), ends, strict=True)
        ],
    }
    room = elk.hierarchy.room_of(edge)
    siblings: list[Json] = elk.top if room is None else elk.nodes[room].setdefault("children", [])
    siblings.append(made)
    elk.joints[edge.id] = joint
    return joint


def label_height(label: Label) -> float:
    """The height that a label takes beside a line."""
    return max(round(label.height - HEADROOM), 0)
