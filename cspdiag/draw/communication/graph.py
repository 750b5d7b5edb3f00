"""The elements of a communication diagram → the graph that is laid out, with the texts for which it reserves room."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import assert_never

from cspdiag.base.record import record, replaced
from cspdiag.draw.annotations import BADGE, badge_width, has_badge
from cspdiag.draw.communication.ordering import ordered
from cspdiag.draw.communication.symbol_places import SYMBOL_ROOM, parting
from cspdiag.draw.elements.diagram import (
    Arrow,
    Box,
    BoxPort,
    CommunicationDiagram,
    End,
    ParentPort,
    Sink,
    Store,
    Vertex,
    WrittenValue,
)
from cspdiag.draw.elements.marks import Mark, Marks
from cspdiag.draw.hiding import Hidden
from cspdiag.draw.layout.elk_graph import HEADROOM
from cspdiag.draw.layout.graph import Edge, Graph, Label, Layer, Node, Padding, Port, Side
from cspdiag.draw.scene.shapes import Face, Ink, TextRun
from cspdiag.draw.scene.text_metrics import line_height, runs_width

NAME_SIZE = 13.0
PORT_SIZE = 11.0
LABEL_SIZE = 11.5
BOX_WIDTH = 110.0
PARENT_HEIGHT = 18.0
INSIDE_GAP = 24.0
"""Between the names of the ports of a box and what it shows inside."""
SINK_SIZE = 12.0
STORE_HEIGHT = 26.0
STORE_GAP = 12.0
"""Between the sides of a variable and its text."""
BADGE_GAP = 4.0
"""Between a text and the badge beside it."""
BADGE_HEIGHT = 2 * BADGE + HEADROOM
"""The extra height of labels with a badge: unlike letters it fills all of its room."""


@record
class Caption:
    """A text for which the layout leaves room: a line for each tuple of runs."""

    lines: tuple[tuple[TextRun, ...], ...]
    size: float
    mark: Mark | None = None
    """The mark whose badge is next to the text; the badge takes room even without a text."""

    @property
    def text_width(self) -> float:
        """In pixels, without the badge."""
        return max((runs_width(line, self.size) for line in self.lines), default=0)

    @property
    def text_height(self) -> float:
        """In pixels, without the badge."""
        return len(self.lines) * line_height(self.size)

    @property
    def width(self) -> float:
        """In pixels."""
        if self.mark is None:
            return self.text_width
        return self.text_width + (BADGE_GAP if self.lines else 0) + badge_width(self.mark)

    @property
    def height(self) -> float:
        """In pixels."""
        return max(self.text_height, 0 if self.mark is None else BADGE_HEIGHT)


@dataclass
class CommunicationGraph:
    """A graph, and what its parts represent, by their identifiers."""

    graph: Graph = field(default_factory=lambda: Graph(()))
    apart: tuple[Node, ...] = ()
    """Nodes without arrows, such as variables that only the composition uses; they are drawn below the rest."""
    captions: dict[str, Caption] = field(default_factory=dict)
    vertices: dict[str, Vertex] = field(default_factory=dict)
    ports: dict[str, BoxPort] = field(default_factory=dict)
    arrows: dict[str, Arrow] = field(default_factory=dict)


def communication_graph(diagram: CommunicationDiagram, hidden: Hidden, marks: Marks) -> CommunicationGraph:
    """The graph of a diagram and of everything that it shows inside its boxes. The identifier of an element is its key
    after that of the box around it: ``horizontal/alignL``. A port of a box is ``horizontal/alignL|max``. Badges of
    ``marks`` get room next to texts and lines; at the corner of a shape they need none.
    """
    made = CommunicationGraph()
    nodes, edges = _Level(made, hidden, marks, "").level(diagram)
    made.graph = Graph(nodes=nodes, edges=edges)
    return made


class _Level:
    """Makes the nodes and edges of one diagram; ``prefix`` begins the identifiers of what is inside a box."""

    def __init__(
        self, made: CommunicationGraph, hidden: Hidden, marks: Marks, prefix: str, around: Box | None = None
    ) -> None:
        self.made = made
        self.hidden = hidden
        self.marks = marks
        self.prefix = prefix
        self.around = around
        self.at_border: dict[str, list[BoxPort]] = {}
        """By parent port: the ports of the box around that represent it, or elements of it."""

    def level(self, diagram: CommunicationDiagram) -> tuple[tuple[Node, ...], tuple[Edge, ...]]:
        if self.around is not None:
            self._find_border(self.around, diagram)
        self.types = {(box.key, port.key): port.type for box in diagram.boxes for port in box.ports}
        used = {end.element for arrow in diagram.arrows for end in (*arrow.sources, *arrow.sinks)}
        drawn = [vertex for vertex in ordered(diagram) if vertex.key not in self.at_border]
        if not self.prefix:
            self.made.apart = tuple(
                self._node(vertex, {"in": 0, "out": 0}, False)
                for vertex in diagram.vertices
                if vertex.key not in used and not isinstance(vertex, Box)
            )
            drawn = [vertex for vertex in drawn if vertex.key in used or isinstance(vertex, Box)]
        widths = {
            direction: max(
                (
                    self._parent_caption(v).width
                    for v in drawn
                    if isinstance(v, ParentPort) and v.direction == direction
                ),
                default=0,
            )
            for direction in ("in", "out")
        }
        self.parting = set(parting(diagram.arrows))
        nodes = tuple(self._node(vertex, widths, vertex.key in used) for vertex in drawn)
        return nodes, tuple(self._edge(arrow) for arrow in diagram.arrows)

    def _find_border(self, around: Box, inside: CommunicationDiagram) -> None:
        for vertex in inside.vertices:
            if isinstance(vertex, ParentPort):
                own = [port for port in around.ports if port.name == vertex.key]
                if own:
                    self.at_border[vertex.key] = own

    def _id(self, key: str) -> str:
        return f"{self.prefix}{key}"

    def _node(self, vertex: Vertex, widths: dict[str, float], is_used: bool) -> Node:
        name = self._id(vertex.key)
        self.made.vertices[name] = vertex
        match vertex:
            case Box():
                return self._box(vertex, name)
            case ParentPort():
                caption = self._parent_caption(vertex)
                width = max(widths[vertex.direction], caption.width) + 6
                is_in = vertex.direction == "in"
                layer = Layer.FIRST if is_in else Layer.LAST
                return self._small(name, caption, width, PARENT_HEIGHT, layer, is_used)
            case Store():
                caption = self._store_caption(vertex)
                return self._small(name, caption, caption.width + 2 * STORE_GAP, STORE_HEIGHT, Layer.ANY, is_used)
            case WrittenValue():
                text = (TextRun(vertex.text, Face.MONO, Ink.FAINT),)
                caption = Caption((text,), PORT_SIZE, self._badged(name))
                return self._small(
                    name, caption, caption.width + 6, max(caption.text_height + 4, caption.height), Layer.ANY, is_used
                )
            case Sink():
                return self._small(name, None, SINK_SIZE, SINK_SIZE, Layer.ANY, is_used)
            case _:
                assert_never(vertex)

    def _small(
        self, name: str, caption: Caption | None, width: float, height: float, layer: Layer, is_used: bool
    ) -> Node:
        """A node without ports of its own: arrows end in the middle of its left side and begin in the middle of its
        right side.
        """
        if caption is not None:
            self.made.captions[name] = caption
        ports = (Port(f"{name}|<", Side.WEST), Port(f"{name}|>", Side.EAST))
        return Node(name, width, height, ports=ports, layer=layer if is_used else Layer.ANY)

    def _box(self, box: Box, name: str) -> Node:
        caption = box_caption(box)
        title = self._label(f"{name}#title", caption)
        ports = []
        for port in box.ports:
            port_name = f"{name}|{port.key}"
            self.made.ports[port_name] = port
            label = None
            if not self.hidden.hides("ports", port.key):
                label = self._label(f"{port_name}#name", port_caption(port))
            ports.append(Port(port_name, Side.WEST if port.direction == "in" else Side.EAST, label))
        children: tuple[Node, ...] = ()
        edges: tuple[Edge, ...] = ()
        padding = Padding()
        if box.inside is not None:
            children, edges = _Level(self.made, self.hidden, self.marks, f"{name}/", box).level(box.inside)
            left, right = (
                max((port.label.width for port in ports if port.label and port.side is side), default=0)
                for side in (Side.WEST, Side.EAST)
            )
            padding = Padding(14, right + INSIDE_GAP, 18, left + INSIDE_GAP)
        return Node(
            name,
            BOX_WIDTH,
            0,
            title=title,
            ports=tuple(ports),
            children=children,
            edges=edges,
            padding=padding,
        )

    def _edge(self, arrow: Arrow) -> Edge:
        name = self._id(arrow.key)
        self.made.arrows[name] = arrow
        caption = self._arrow_caption(arrow)
        if caption.lines or not self._goes_with_value(arrow):
            caption = replaced(caption, mark=self._badged(name))
        label = self._label(f"{name}#label", caption) if caption.width > 0 else None
        if arrow.key in self.parting:
            # The symbol is drawn below the label, where the arrow runs alone.
            label = replaced(label or self._label(f"{name}#label", caption), width=max(caption.width, SYMBOL_ROOM))
        sources = tuple(dict.fromkeys(place for end in arrow.sources for place in self._end(end, ">")))
        sinks = tuple(dict.fromkeys(place for end in arrow.sinks for place in self._end(end, "<")))
        return Edge(f"{name}#edge", sources, sinks, label, priority=0 if arrow.by_composition else 10)

    def _goes_with_value(self, arrow: Arrow) -> bool:
        """Whether an arrow belongs to an expression that has a badge of its own."""
        ends = [self._id(end.element) for end in (*arrow.sources, *arrow.sinks)]
        return any(end in self.marks and isinstance(self.made.vertices.get(end), WrittenValue) for end in ends)

    def _end(self, end: End, side: str) -> list[str]:
        """Where an arrow begins or ends: at several ports of the box around, if connected element by element."""
        if end.element in self.at_border:
            outer = self.prefix.removesuffix("/")
            return [f"{outer}|{port.key}" for port in elements_of(self.at_border[end.element], end.port or "")]
        name = self._id(end.element)
        vertex = self.made.vertices.get(name)
        if isinstance(vertex, Box):
            return [f"{name}|{end.port}" if end.port is not None else name]
        return [f"{name}|{side}"]

    def _label(self, name: str, caption: Caption) -> Label:
        self.made.captions[name] = caption
        return Label(name, caption.width, caption.height)

    def _parent_caption(self, port: ParentPort) -> Caption:
        runs = [TextRun(f"{port.key}{port.size or ''}")]
        if not self.hidden.hides("types", port.key):
            runs.append(TextRun(f": {port.type}", ink=Ink.FAINT))
        if port.period is not None and not self.hidden.hides("periods"):
            runs.append(TextRun(f" @{port.period}", Face.ITALIC))
        return Caption((tuple(runs),), NAME_SIZE, self._badged(self._id(port.key)))

    def _badged(self, name: str) -> Mark | None:
        """The mark of an element if it has a badge."""
        mark = self.marks.get(name)
        return mark if mark is not None and has_badge(mark) else None

    def _store_caption(self, store: Store) -> Caption:
        runs = [TextRun(store.key)]
        if store.type and not self.hidden.hides("types", store.key):
            runs.append(TextRun(f": {store.type}", ink=Ink.FAINT))
        if store.initial is not None and not self.hidden.hides("types", store.key):
            runs.append(TextRun(f" = {store.initial}", ink=Ink.FAINT))
        if store.requested is not None and not self.hidden.hides("kinds"):
            kind = store.requested if store.capacity is None else f"{store.requested} {store.capacity}"
            runs.append(TextRun(f" {kind}", Face.ITALIC, Ink.FAINT))
        return Caption((tuple(runs),), LABEL_SIZE)

    def _arrow_caption(self, arrow: Arrow) -> Caption:
        """``leftmax: double<rad> broadcast``; the type of an arrow without a label is that of the port where
        it begins.
        """
        words: list[TextRun] = []
        if arrow.by_composition:
            return Caption((), LABEL_SIZE)
        for end in (*arrow.sources, *arrow.sinks):
            if end.port is not None and (end.element, end.port) not in self.types:
                words.append(TextRun(f"{' ' if words else ''}{end.element}{end.port}"))
        if arrow.label is not None and not self.hidden.hides("labels", arrow.label):
            words.append(TextRun(f"{' ' if words else ''}{arrow.label}"))
        type_ = self._type_of(arrow)
        if type_ and not self.hidden.hides("types", arrow.label or ""):
            words.append(TextRun(f": {type_}" if words else type_, ink=Ink.FAINT))
        if arrow.requested is not None and not self.hidden.hides("kinds"):
            kind = arrow.requested if arrow.capacity is None else f"{arrow.requested} {arrow.capacity}"
            words.append(TextRun(f"{' ' if words else ''}{kind}", Face.ITALIC, Ink.FAINT))
        if arrow.repeated and not self.hidden.hides("labels"):
            text = ", ".join(arrow.repeated)
            words.append(TextRun(f"{'   ' if words else ''}{text}", Face.ITALIC, Ink.FAINT))
        return Caption((tuple(words),) if words else (), LABEL_SIZE)

    def _type_of(self, arrow: Arrow) -> str | None:
        ports = [(end.element, end.port or "") for end in (*arrow.sources, *arrow.sinks)]
        if any(port not in self.types for port in ports):
            # The port or variable at that end shows the type itself.
            return None
        return arrow.type or next((self.types[port] for port in ports if self.types[port] != "?"), None)


def elements_of(ports: Sequence[BoxPort], index: str) -> Sequence[BoxPort]:
    """The ports of a box that may be the element ``[2]`` of a port, as seen from inside the box: the one with this
    number, or else those whose numbers come from a replicator, or else all.
    """
    if not _NUMBERS.fullmatch(index):
        return ports
    same = [port for port in ports if port.index == index]
    replicated = [port for port in ports if not _NUMBERS.fullmatch(port.index)]
    return same or replicated or ports


_NUMBERS = re.compile(r"(\[\d+\])+")


def box_caption(box: Box) -> Caption:
    """``cell[8]: Cell``, and the language of a hand-written body below it."""
    size = f"[{box.size}]" if box.size else ""
    if box.key == box.definition and not size:
        lines: list[tuple[TextRun, ...]] = [(TextRun(box.key, Face.BOLD),)]
    else:
        lines = [(TextRun(f"{box.key}{size}", Face.BOLD), TextRun(f": {box.definition}"))]
    if box.language is not None:
        lines.append((TextRun(f"hand-written in {box.language}", Face.ITALIC, Ink.FAINT),))
    return Caption(tuple(lines), NAME_SIZE)


def port_caption(port: BoxPort) -> Caption:
    """The local name of a port, with its default if it is not connected."""
    runs = [TextRun(port.key, ink=Ink.FAINT)]
    if port.default is not None:
        runs.append(TextRun(f" = {port.default}", Face.ITALIC, Ink.FAINT))
    return Caption((tuple(runs),), PORT_SIZE)
