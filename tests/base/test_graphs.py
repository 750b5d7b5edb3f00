"""Components and cycles, compared with networkx."""

from __future__ import annotations

import networkx
from hypothesis import given
from hypothesis import strategies as st

from cspdiag.base.graphs import final_components, is_circular, shortest_circle, strong_components

graphs = st.integers(1, 12).flatmap(
    lambda n: st.lists(st.lists(st.integers(0, n - 1), max_size=3), min_size=n, max_size=n)
)


def graph_of(after: list[list[int]]) -> networkx.DiGraph:
    graph = networkx.DiGraph()
    graph.add_nodes_from(range(len(after)))
    graph.add_edges_from((node, target) for node, targets in enumerate(after) for target in targets)
    return graph


@given(graphs)
def test_components_are_complete_and_come_after_those_they_lead_to(after: list[list[int]]) -> None:
    found = list(strong_components(range(len(after)), after.__getitem__))
    expected = networkx.strongly_connected_components(graph_of(after))
    assert sorted(map(sorted, found)) == sorted(map(sorted, expected))
    done: set[int] = set()
    for component in found:
        done.update(component)
        assert done.issuperset(target for node in component for target in after[node])


@given(graphs)
def test_only_what_the_roots_lead_to_is_found(after: list[list[int]]) -> None:
    reached = {node for component in strong_components([0], after.__getitem__) for node in component}
    assert reached == {0, *networkx.descendants(graph_of(after), 0)}


@given(graphs)
def test_no_edge_leaves_a_final_component(after: list[list[int]]) -> None:
    expected = networkx.attracting_components(graph_of(after))
    assert sorted(map(sorted, final_components(after))) == sorted(map(sorted, expected))


@given(graphs)
def test_a_circle_is_a_shortest_one(after: list[list[int]]) -> None:
    graph = graph_of(after)
    for component in strong_components(range(len(after)), after.__getitem__):
        circle = shortest_circle(component, after.__getitem__)
        assert bool(circle) == is_circular(component, after.__getitem__)
        if circle:
            assert circle[0] == component[0]
            for node, following in zip(circle, [*circle[1:], circle[0]], strict=True):
                assert following in after[node]
            lengths = networkx.single_source_shortest_path_length(graph, circle[0])
            assert len(circle) == 1 + min(lengths[node] for node in component if circle[0] in after[node])
