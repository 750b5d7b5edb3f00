"""Layouts of random graphs: the engine returns a drawing of the given graph."""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations, pairwise
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from cspdiag.draw.layout import elk, engine
from cspdiag.draw.layout.elk import engine_available, lay_out
from cspdiag.draw.layout.elk_graph import elk_graph
from cspdiag.draw.layout.graph import (
    Direction,
    Edge,
    Graph,
    Label,
    Layer,
    Layout,
    Node,
    Port,
    PortOrder,
    Route,
    Section,
    Side,
)
from cspdiag.draw.layout.joined import joined
from cspdiag.draw.scene.geometry import Point, Rectangle

needs_engine = pytest.mark.skipif(not engine_available(), reason="the layout engine was not fetched (make setup)")


@st.composite
def graphs(draw: st.DrawFn) -> Graph:
    """Up to six boxes, some with two parts inside, joined by up to six edges of one or several ends."""
    names = [f"n{index}" for index in range(draw(st.integers(1, 6)))]
    with_parts = {name for name in names if draw(st.integers(0, 4)) == 0}
    nodes = [node(draw, name, name in with_parts) for name in names]
    sources = [f"{name}.{port}" for name in names for port in ("out", "aux")]
    targets = [f"{name}.{port}" for name in names for port in ("in", "back")]
    edges = []
    for index in range(draw(st.integers(0, 6))):
        begins = draw(st.lists(st.sampled_from(sources), min_size=1, max_size=3, unique=True))
        ends = draw(st.lists(st.sampled_from(targets), min_size=1, max_size=3, unique=True))
        label = Label(f"e{index}.label", draw(st.integers(10, 120)), 13) if draw(st.booleans()) else None
        edges.append(Edge(f"e{index}", tuple(begins), tuple(ends), label))
    direction = draw(st.sampled_from(Direction))
    order = draw(st.sampled_from(PortOrder))
    return Graph(tuple(sided(each, direction, order) for each in nodes), tuple(edges), direction)


def node(draw: st.DrawFn, name: str, has_parts: bool) -> Node:
    ports = tuple(
        Port(f"{name}.{port}", side, Label(f"{name}.{port}.label", draw(st.integers(8, 60)), 12))
        for port, side in (("in", Side.WEST), ("back", Side.WEST), ("out", Side.EAST), ("aux", Side.EAST))
    )
    title = Label(f"{name}.title", draw(st.integers(20, 140)), 15)
    if not has_parts:
        return Node(name, draw(st.integers(0, 90)), 0, title, ports)
    parts = (
        Node(f"{name}/a", 60, 30, ports=(Port(f"{name}/a.in", Side.WEST), Port(f"{name}/a.out", Side.EAST))),
        Node(f"{name}/b", 60, 30, ports=(Port(f"{name}/b.in", Side.WEST), Port(f"{name}/b.out", Side.EAST))),
    )
    inner = (
        Edge(f"{name}/1", (f"{name}.in",), (f"{name}/a.in", f"{name}/b.in"), Label(f"{name}/1.label", 40, 13)),
        Edge(f"{name}/2", (f"{name}/a.out",), (f"{name}.out",)),
    )
    return Node(name, 0, 0, title, ports, children=parts, edges=inner)


def sided(each: Node, direction: Direction, order: PortOrder) -> Node:
    """The node with its ports on the sides that suit their directions; free ones only if there is nothing inside."""
    turned = {Side.WEST: Side.NORTH, Side.EAST: Side.SOUTH}
    free = order is PortOrder.FREE and not each.children

    def side(port: Port) -> Side | None:
        assert port.side is not None
        return None if free else port.side if direction is Direction.RIGHT else turned[port.side]

    ports = tuple(Port(port.id, side(port), port.label) for port in each.ports)
    children = tuple(sided(child, direction, PortOrder.FIXED_SIDE) for child in each.children)
    kept = order if free or order is not PortOrder.FREE else PortOrder.FIXED_SIDE
    return Node(each.id, each.width, each.height, each.title, ports, kept, children, each.edges)


@needs_engine
@settings(max_examples=10, deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=True)
@given(graphs())
def test_a_layout_is_a_drawing_of_its_graph(graph: Graph) -> None:
    layout = lay_out(graph)
    boxes_hold_what_is_in_them_and_do_not_overlap(graph, layout)
    every_edge_joins_its_ends_at_right_angles(graph, layout)
    labels_lie_on_no_box_and_no_other_label(graph, layout)


def boxes_hold_what_is_in_them_and_do_not_overlap(graph: Graph, layout: Layout) -> None:
    sheet = Rectangle(0, 0, layout.width, layout.height).grown(0.5)
    for each in graph.nodes:
        place = layout.nodes[each.id]
        assert sheet.contains(place)
        assert each.title is not None
        assert place.contains(layout.labels[each.title.id])
        assert all(place.contains(layout.nodes[child.id]) for child in each.children)
    for siblings in (graph.nodes, *(each.children for each in graph.nodes)):
        for first, second in combinations(siblings, 2):
            assert not layout.nodes[first.id].overlaps(layout.nodes[second.id])


def every_edge_joins_its_ends_at_right_angles(graph: Graph, layout: Layout) -> None:
    for edge in (*graph.edges, *(inner for each in graph.nodes for inner in each.edges)):
        route = layout.routes[edge.id]
        assert {section.source for section in route.sections} - {None} == set(edge.sources)
        assert {section.target for section in route.sections} - {None} == set(edge.targets)
        for section in route.sections:
            for first, second in pairwise(section.points):
                assert first != second
                assert first.x == second.x or first.y == second.y
            if section.target:
                assert section.points[-1] == layout.ports[section.target]
        assert reached(route) == set(edge.targets)


def reached(route: Route) -> set[str]:
    """The targets that can be reached from the sources along the sections, whichever way they are drawn."""
    points = {section.points[0] for section in route.sections if section.source}
    ends = [(section.points[0], section.points[-1]) for section in route.sections]
    ends += [(last, first) for first, last in ends]
    while not (more := {last for first, last in ends if first in points}) <= points:
        points |= more
    return {section.target for section in route.sections if section.target and section.points[-1] in points}


def labels_lie_on_no_box_and_no_other_label(graph: Graph, layout: Layout) -> None:
    # Letters leave space at the top of a line.
    labels = [layout.labels[edge.label.id].grown(-1.6) for edge in graph.edges if edge.label]
    for label in labels:
        assert not any(label.overlaps(layout.nodes[each.id]) for each in graph.nodes)
    assert not any(first.overlaps(second) for first, second in combinations(labels, 2))


@needs_engine
def test_the_same_graph_gets_the_same_layout() -> None:
    nodes = tuple(box(f"b{index}", 2, 2) for index in range(5))
    edges = tuple(Edge(f"e{index}", (f"b{index}.out0",), (f"b{(index * 2 + 1) % 5}.in1",)) for index in range(5))
    assert lay_out(Graph(nodes, edges)) == lay_out(Graph(nodes, edges))


def box(name: str, inputs: int = 1, outputs: int = 1) -> Node:
    return Node(
        name,
        80,
        title=Label(f"{name}.title", 60, 15),
        ports=(
            *(
                Port(f"{name}.in{index}", Side.WEST, Label(f"{name}.in{index}.label", 20, 12))
                for index in range(inputs)
            ),
            *(
                Port(f"{name}.out{index}", Side.EAST, Label(f"{name}.out{index}.label", 20, 12))
                for index in range(outputs)
            ),
        ),
    )


@needs_engine
def test_an_additional_box_moves_none_above_it() -> None:
    """Branches in the order of the text: a branch added at the end is drawn at the end."""
    branches = [box(f"b{index}") for index in range(4)]

    def layout_of(count: int) -> Layout:
        edges = tuple(Edge(f"e{index}", ("source.out0",), (f"b{index}.in0",)) for index in range(count))
        return lay_out(Graph((box("source", 0), *branches[:count]), edges))

    before, after = layout_of(3), layout_of(4)
    heights = [after.nodes[f"b{index}"].y for index in range(4)]
    assert heights == sorted(heights)
    assert [after.nodes[f"b{index}"] for index in range(3)] == [before.nodes[f"b{index}"] for index in range(3)]


@needs_engine
def test_ends_of_the_diagram_are_at_its_sides() -> None:
    first = Node("first", 50, 18, layer=Layer.FIRST)
    last = Node("last", 50, 18, layer=Layer.LAST)
    chain = (Edge("1", ("a.out0",), ("b.in0",)), Edge("2", ("first",), ("b.in1",)), Edge("3", ("a.out1",), ("last",)))
    layout = lay_out(Graph((box("a", 1, 2), box("b", 2), first, last), chain))
    assert layout.nodes["first"].right <= layout.nodes["b"].x
    assert layout.nodes["last"].x >= layout.nodes["a"].right


@needs_engine
def test_a_long_chain_is_broken_into_rows() -> None:
    def chain(length: int) -> Layout:
        boxes = tuple(box(f"b{index}") for index in range(length))
        edges = tuple(
            Edge(f"e{index}", (f"b{index}.out0",), (f"b{index + 1}.in0",), Label(f"e{index}.label", 60, 13))
            for index in range(length - 1)
        )
        return lay_out(Graph(boxes, edges))

    short, long = chain(6), chain(30)
    assert len({place.y for place in short.nodes.values()}) == 1
    assert len({place.y for place in long.nodes.values()}) > 3
    assert long.width < 3 * long.height
    places = [*long.nodes.values(), *(long.labels[f"e{index}.label"] for index in range(29))]
    assert not any(first.overlaps(second) for first, second in combinations(places, 2))
    assert all(reached(long.routes[f"e{index}"]) == {f"b{index + 1}.in0"} for index in range(29))


@needs_engine
def test_a_large_chain_is_laid_out_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(elk, "LARGE", 100)
    boxes = tuple(box(f"box{number}") for number in range(elk.LARGE))
    lines = tuple(Edge(f"line{n}", (f"box{n}.out0",), (f"box{n + 1}.in0",)) for n in range(len(boxes) - 1))
    back = Edge("back", (f"box{len(boxes) - 1}.out0",), ("box0.in0",))
    runs: list[bool] = []

    def counted(graph: dict[str, Any], run: Callable[[dict[str, Any]], dict[str, Any]] = engine.run) -> dict[str, Any]:
        runs.append("elk.layered.wrapping.strategy" in graph["layoutOptions"])
        return run(graph)

    monkeypatch.setattr(engine, "run", counted)
    chain, ring = Graph(boxes, lines), Graph(boxes, (*lines, back))
    found = [lay_out(graph) for graph in (chain, ring)]
    assert runs == [True, True]
    monkeypatch.setattr(elk, "LARGE", len(boxes) + 1)
    assert found == [lay_out(graph) for graph in (chain, ring)]
    assert runs == [True, True, False, True, False, True]


def test_a_large_graph_of_few_layers_stays_in_one_row() -> None:
    pairs = range(elk.LARGE // 2)
    boxes = tuple(box(f"{kind}{number}") for number in pairs for kind in ("left", "right"))
    lines = tuple(Edge(f"line{n}", (f"left{n}.out0",), (f"right{n}.in0",)) for n in pairs)
    assert not elk._is_surely_too_wide(elk_graph(Graph(boxes, lines)))


@needs_engine
def test_ports_in_a_fixed_order_are_in_the_order_of_the_text() -> None:
    ports = tuple(Port(f"p{index}", Side.WEST) for index in range(5))
    node = Node("n", 40, 40, Label("t", 20, 10), ports, PortOrder.FIXED_ORDER)
    sources = tuple(Node(f"s{index}", 20, 20) for index in range(5))
    crossed = tuple(Edge(f"e{index}", (f"s{4 - index}",), (f"p{index}",)) for index in range(5))
    layout = lay_out(Graph((*sources, node), crossed))
    heights = [layout.ports[f"p{index}"].y for index in range(5)]
    assert heights == sorted(set(heights))


@pytest.mark.parametrize(
    ("graph", "problem"),
    [
        (Graph((Node("a"), Node("a"))), "the identifier 'a' is given twice"),
        (Graph((Node("a"),), (Edge("e", ("a",), ("b",)),)), "ends at 'b'"),
        (
            Graph((Node("a", children=(Node("inside"),)), Node("b")), (Edge("e", ("inside",), ("b",)),)),
            "leads through the border",
        ),
    ],
)
def test_an_invalid_graph_is_refused(graph: Graph, problem: str) -> None:
    with pytest.raises(ValueError, match=problem):
        lay_out(graph)


def test_lines_that_share_a_part_are_joined_where_they_fork() -> None:
    start, fork = Point(0, 0), Point(10, 0)
    lines = [[start, Point(30, 0)], [start, fork, Point(10, 20), Point(30, 20)]]
    route = joined(lines, {start: "a"}, {Point(30, 0): "b", Point(30, 20): "c"})
    assert route.junctions == (fork,)
    assert route.sections == (
        Section((start, fork), "a", None),
        Section((fork, Point(30, 0)), None, "b"),
        Section((fork, Point(10, 20), Point(30, 20)), None, "c"),
    )
