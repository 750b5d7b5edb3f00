"""Draws communication diagrams."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import assert_never

from cspdiag.base import Diagnostic
from cspdiag.base.record import replaced
from cspdiag.draw.annotations import BADGE, INKS, SMALLEST_ROW, badge, badge_width, has_badge, heading, messages
from cspdiag.draw.communication import symbols
from cspdiag.draw.communication.graph import BADGE_GAP, Caption, CommunicationGraph, communication_graph
from cspdiag.draw.communication.legend import legend
from cspdiag.draw.communication.symbol_places import CORNER, symbol_pieces
from cspdiag.draw.communication.tooltips import (
    arrow_tooltip,
    box_tooltip,
    parent_port_tooltip,
    port_tooltip,
    sink_tooltip,
    store_tooltip,
    value_tooltip,
)
from cspdiag.draw.elements.diagram import (
    Arrow,
    Box,
    CommunicationDiagram,
    ParentPort,
    Sink,
    Store,
    Vertex,
    WrittenValue,
)
from cspdiag.draw.elements.marks import WHOLE, Mark, Marks
from cspdiag.draw.hiding import NOTHING_HIDDEN, Hidden
from cspdiag.draw.layout.elk import lay_out
from cspdiag.draw.layout.graph import Layout, Node, Side
from cspdiag.draw.scene.geometry import Point, Rectangle
from cspdiag.draw.scene.scene_geometry import below_each_other, bounds, fitted
from cspdiag.draw.scene.shapes import Anchor, Dash, Face, Group, Head, Ink, Item, Line, Scene, Text, TextRun
from cspdiag.draw.scene.text_metrics import ASCENT, line_height
from cspdiag.network.ir.network import Direction

ROW_GAP = 24.0
"""Around elements without neighbours."""
GAP = 26.0
"""Between heading, drawing, legend and messages."""
CORNER_RISE = 2.0
"""How far the middle of a badge at a corner is outside the shape, so it does not cover the text inside."""
TEXT_MARGIN = 3.0
"""Between the side of a node that is only a text, where its arrows end, and the text."""


def draw_communication(
    diagram: CommunicationDiagram,
    *,
    hidden: Hidden = NOTHING_HIDDEN,
    marks: Marks | None = None,
    diagnostics: Mapping[int, Diagnostic] | None = None,
    links: Mapping[str, str] | None = None,
) -> Scene:
    """A communication diagram with its heading, a legend of the symbols that occur, and the messages to which the marks
    refer.

    ``marks`` are by the key of the element, below that of the box around it (``horizontal/alignL``), and by WHOLE for
    the diagram as a whole; ``links`` lead from a definition to an address. Raises the same exceptions as ``lay_out``.
    """
    marks = dict(marks or {})
    mark_of_whole = marks.pop(WHOLE, None)
    made = communication_graph(diagram, hidden, marks)
    layout = _with_row(lay_out(made.graph), made.apart) if made.graph.nodes else _with_row(Layout(0, 0, {}), made.apart)
    picture = _Drawing(made, layout, marks, links or {}).picture()
    parts: list[Item] = [heading(_title(diagram), diagram.doc, mark_of_whole)]
    if picture:
        parts.append(Group("diagram", picture))
    width = max(SMALLEST_ROW, bounds(parts[-1]).width)
    explained = legend(made.vertices.values(), made.arrows.values(), width)
    if explained is not None and not hidden.hides("legend"):
        parts.append(explained)
    if diagnostics:
        parts.append(messages(diagnostics.items(), width))
    return fitted(below_each_other(parts, GAP), title=diagram.key, description=diagram.doc or "", name=diagram.key)


def _with_row(layout: Layout, apart: Sequence[Node]) -> Layout:
    """The layout, with further nodes in rows below it."""
    nodes = dict(layout.nodes)
    x, y = 0.0, layout.height + ROW_GAP if layout.nodes else 0.0
    for node in apart:
        if x > 0 and x + node.width > max(layout.width, SMALLEST_ROW):
            x, y = 0.0, y + node.height + ROW_GAP / 2
        nodes[node.id] = Rectangle(x, y, node.width, node.height)
        x += node.width + ROW_GAP
    return replaced(layout, nodes=nodes)


def _title(diagram: CommunicationDiagram) -> tuple[TextRun, ...]:
    if diagram.environment_of is not None:
        return (
            TextRun("environment ", ink=Ink.FAINT),
            TextRun(diagram.key, Face.BOLD),
            TextRun(f" for {diagram.environment_of}"),
        )
    names = ", ".join(parameter.partition(":")[0].strip() for parameter in diagram.parameters)
    parameters = (TextRun(f"({names})", ink=Ink.FAINT),) if names else ()
    return (TextRun("process ", ink=Ink.FAINT), TextRun(diagram.key, Face.BOLD), *parameters)


class _Drawing:
    """Draws shapes and texts at the places of the layout."""

    def __init__(self, made: CommunicationGraph, layout: Layout, marks: Marks, links: Mapping[str, str]) -> None:
        self.made = made
        self.layout = layout
        self.marks = marks
        self.links = links
        self.routes = {name: layout.routes[f"{name}#edge"] for name in made.arrows}
        self.symbols = {name: symbols.symbol_of(arrow) for name, arrow in made.arrows.items()}
        self.pieces = symbol_pieces(self.routes, self.symbols)
        self.corners: list[Rectangle] = []
        """The places of badges at corners."""

    def picture(self) -> tuple[Item, ...]:
        """The boxes, outer ones first, then the arrows on top of them, then badges."""
        boxes = [self._vertex(name, vertex) for name, vertex in self.made.vertices.items()]
        arrows = [self._arrow(name, arrow) for name, arrow in self.made.arrows.items()]
        badges = [self._badge(name, mark) for name, mark in self.marks.items()]
        return (*boxes, *arrows, *(item for item in badges if item is not None))

    def _vertex(self, name: str, vertex: Vertex) -> Item:
        place = self.layout.nodes[name]
        mark = self.marks.get(name)
        match vertex:
            case Box():
                return self._box(name, vertex, place, mark)
            case ParentPort():
                is_in = vertex.direction == "in"
                text = self._beside(name, place, Anchor.END if is_in else Anchor.START, mark)
                return Group("port", (text,), name, _with_note(parent_port_tooltip(vertex), mark))
            case Store():
                shapes = symbols.store(vertex, place, mark)
                return Group(
                    vertex.form, (*shapes, self._centred(name, place)), name, _with_note(store_tooltip(vertex), mark)
                )
            case WrittenValue():
                return Group(
                    "value",
                    (self._beside(name, place, Anchor.END, mark),),
                    name,
                    _with_note(value_tooltip(vertex), mark),
                )
            case Sink():
                return Group("sink", symbols.sink(place, mark), name, _with_note(sink_tooltip(vertex), mark))
            case _:
                assert_never(vertex)

    def _box(self, name: str, box: Box, place: Rectangle, mark: Mark | None) -> Item:
        items: list[Item] = [*symbols.instance(box, place, mark)]
        title = self.made.captions[f"{name}#title"]
        items += _lines(title, self.layout.labels[f"{name}#title"], Anchor.MIDDLE)
        for port in box.ports:
            items.append(self._port(f"{name}|{port.key}", name))
        kind = f"{box.kind} hand-written" if box.language else box.kind
        link = self.links.get(box.definition, "")
        return Group(f"instance {kind}", tuple(items), name, _with_note(box_tooltip(box), mark), link)

    def _port(self, name: str, box: str) -> Item:
        port = self.made.ports[name]
        at = self.layout.ports[name]
        mark = self.marks.get(f"{box}.{port.key}")
        inwards = -1 if self.layout.sides[name] is Side.EAST else 1
        items: list[Item] = [symbols.port(at, mark, is_connected=port.is_connected, inwards=inwards)]
        label = self.layout.labels.get(f"{name}#name")
        if label is not None:
            anchor = Anchor.END if inwards < 0 else Anchor.START
            items += _lines(self.made.captions[f"{name}#name"], label, anchor)
        return Group(f"port {port.direction}", tuple(items), name, _with_note(port_tooltip(port), mark))

    def _centred(self, name: str, place: Rectangle) -> Item:
        caption = self.made.captions[name]
        baseline = place.centre.y + (ASCENT - line_height(1) / 2) * caption.size
        return Text(Point(place.centre.x + 2, baseline), caption.lines[0], caption.size, Anchor.MIDDLE)

    def _beside(self, name: str, place: Rectangle, anchor: Anchor, mark: Mark | None) -> Item:
        caption = self.made.captions[name]
        baseline = place.centre.y + (ASCENT - line_height(1) / 2) * caption.size
        x = place.right - TEXT_MARGIN if anchor is Anchor.END else place.x + TEXT_MARGIN
        return Text(Point(x, baseline), _inked(caption.lines[0], mark), caption.size, anchor)

    def _arrow(self, name: str, arrow: Arrow) -> Item:
        mark = self.marks.get(name)
        items: list[Item] = [*self._lines_of(name, arrow, mark)]
        caption = self.made.captions.get(f"{name}#label")
        place = self.layout.labels.get(f"{name}#label")
        if caption is not None and place is not None:
            inked = replaced(caption, lines=tuple(_inked(line, mark) for line in caption.lines))
            items += _lines(inked, place, Anchor.START)
        kind = " ".join(("channel", *arrow.kinds)) if not arrow.by_composition else "communication"
        return Group(kind, tuple(items), name, _with_note(arrow_tooltip(arrow), mark))

    def _lines_of(self, name: str, arrow: Arrow, mark: Mark | None) -> tuple[Item, ...]:
        route = self.routes[name]
        ink, width, dash = symbols.outline(mark, Ink.LINE)
        if arrow.by_composition and mark is None:
            dash = Dash.DASHED
        items: list[Item] = []
        for section in route.sections:
            ends_in_sink = section.target is not None and self._is_sink(section.target)
            continues = section.target is not None and self._is_border(name, section.target, "out")
            head = Head.NONE if section.target is None or ends_in_sink or continues else Head.ARROW
            items.append(Line(section.points, ink, width, dash, end=head, corner=CORNER))
        for junction in route.junctions:
            items.append(Line((junction, junction.moved(0.01, 0)), ink, width, start=Head.DOT))
        kind = self.symbols[name]
        if kind is not None:
            for source, pieces in self.pieces[name].items():
                if not self._is_border(name, source, "in"):
                    for begin, towards in pieces:
                        items += symbols.kind_symbol(kind, begin, towards, ink)
        return tuple(items)

    def _is_sink(self, target: str) -> bool:
        return isinstance(self.made.vertices.get(target.rpartition("|")[0]), Sink)

    def _is_border(self, arrow: str, end: str, direction: Direction) -> bool:
        """Whether an arrow begins or ends at the inner side of the box around it, beyond which it continues."""
        port = self.made.ports.get(end)
        is_inside = arrow.startswith(f"{end.rpartition('|')[0]}/")
        return is_inside and port is not None and port.direction == direction

    def _badge(self, name: str, mark: Mark) -> Item | None:
        """A badge at a corner of a shape, the upper right one if it is free, or next to a text or a line."""
        vertex, place = self.made.vertices.get(name), self.layout.nodes.get(name)
        if not has_badge(mark):
            return None
        half = badge_width(mark) / 2
        if vertex is not None and place is not None:
            if not isinstance(vertex, ParentPort | WrittenValue):
                return badge(mark, self._free(_corners(place, half), half))
            away = TEXT_MARGIN + self.made.captions[name].text_width + BADGE_GAP + half
            is_left = isinstance(vertex, WrittenValue) or vertex.direction == "in"
            return badge(mark, Point(place.right - away if is_left else place.x + away, place.centre.y))
        label = self.layout.labels.get(f"{name}#label")
        if label is not None and self.made.captions[f"{name}#label"].mark is not None:
            return badge(mark, Point(label.right - half, label.bottom - BADGE))
        return None

    def _free(self, candidates: Sequence[Point], half: float) -> Point:
        """The first place where a badge overlaps no label and no other badge, or else the first place."""
        taken = [*self.layout.labels.values(), *self.corners]
        rooms = [Rectangle(at.x - half, at.y - BADGE, 2 * half, 2 * BADGE) for at in candidates]
        free = [place for place, room in enumerate(rooms) if not any(room.overlaps(other) for other in taken)]
        chosen = free[0] if free else 0
        self.corners.append(rooms[chosen])
        return candidates[chosen]


def _corners(place: Rectangle, half: float) -> list[Point]:
    """Possible places of the middle of a badge on a corner of a shape: the right corners first, and of those the upper
    one.
    """
    left, right = place.x - BADGE + BADGE_GAP + half, place.right + BADGE - BADGE_GAP - half
    return [Point(x, y) for x in (right, left) for y in (place.y - CORNER_RISE, place.bottom + CORNER_RISE)]


def _lines(caption: Caption, place: Rectangle, anchor: Anchor) -> list[Item]:
    x = {Anchor.START: place.x, Anchor.MIDDLE: place.centre.x, Anchor.END: place.right}[anchor]
    top = place.y if caption.mark is None else place.bottom - BADGE - caption.text_height / 2
    return [
        Text(Point(x, top + ASCENT * caption.size + row * line_height(caption.size)), line, caption.size, anchor)
        for row, line in enumerate(caption.lines)
    ]


def _inked(runs: tuple[TextRun, ...], mark: Mark | None) -> tuple[TextRun, ...]:
    if mark is None:
        return runs
    ink = INKS[mark.kind][0]
    return tuple(TextRun(run.text, run.face, ink) for run in runs)


def _with_note(tooltip: str, mark: Mark | None) -> str:
    return "\n".join(part for part in (tooltip, mark.note if mark is not None else "") if part)
