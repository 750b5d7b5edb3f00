"""The order of evaluation of equations."""

from __future__ import annotations

import networkx
from hypothesis import given
from hypothesis import strategies as st

from cspdiag.base import SourceFile, Span
from cspdiag.model.types import DOUBLE
from cspdiag.network.ir.equations import ExternalBody, ExternalCall, SubmodelEquation
from cspdiag.network.ir.expressions import ArrayElements, SignalValue
from cspdiag.network.submodels.equation_order import ordered, provides

SPAN = Span(SourceFile(name="case.csp", text=""), 0, 0)


def equation(name: str, *read: str) -> SubmodelEquation:
    values = tuple(SignalValue(type=DOUBLE, name=other) for other in read)
    return SubmodelEquation(name=name, type=DOUBLE, value=ArrayElements(type=DOUBLE, values=values), span=SPAN)


graphs = st.integers(0, 12).flatmap(
    lambda n: st.lists(st.lists(st.integers(0, max(n, 1) + 1), max_size=3), min_size=n, max_size=n)
)


@given(graphs)
def test_every_equation_is_after_those_it_reads_or_in_a_reported_loop(graph: list[list[int]]) -> None:
    items = [equation(str(k), *map(str, read)) for k, read in enumerate(graph)]
    order = ordered(items)
    done: set[str] = set()
    defined = {str(k) for k in range(len(items))}
    for item in order.items:
        assert not (set(item.reads) & defined) - done
        done.update(provides(item))
    knots = networkx.DiGraph()
    knots.add_nodes_from(range(len(items)))
    knots.add_edges_from((k, other) for k, read in enumerate(graph) for other in read if other < len(items))
    circular = [c for c in networkx.strongly_connected_components(knots) if len(c) > 1 or knots.has_edge(*(2 * [*c]))]
    assert len(order.loops) == len(circular)
    for loop in order.loops:
        for item, following in zip(loop, [*loop[1:], loop[0]], strict=True):
            assert following.name in item.reads
        members = next(c for c in circular if int(loop[0].name) in c)
        assert {int(item.name) for item in loop} <= members
        assert int(loop[0].name) == min(members)
    if not circular:
        assert len(order.items) == len(items)


@given(graphs)
def test_equations_that_may_keep_their_place_do(graph: list[list[int]]) -> None:
    forward = [equation(str(k), *(str(other) for other in read if other < k)) for k, read in enumerate(graph)]
    assert list(ordered(forward).items) == forward


def test_ties_are_broken_by_the_text() -> None:
    items = [equation("a", "d"), equation("b"), equation("c", "b"), equation("d"), equation("e")]
    assert [item.name for item in ordered(items).items] == ["b", "c", "d", "a", "e"]


def test_the_loop_shown_is_a_shortest_one() -> None:
    items = [equation("a", "b", "d"), equation("b", "c"), equation("c", "a"), equation("d", "a")]
    (loop,) = ordered(items).loops
    assert [item.name for item in loop] == ["a", "d"]


def test_a_call_is_between_its_inputs_and_its_outputs() -> None:
    call = ExternalCall(
        name="plant",
        span=SPAN,
        external=ExternalBody(language="python", target="plant.py:Plant", span=SPAN),
        definition="Plant",
        arguments=(),
        inputs=(("u", SignalValue(type=DOUBLE, name="force")),),
        outputs=(("y", "plant.y", DOUBLE),),
    )
    items = [equation("out", "plant.y"), call, equation("force", "in")]
    assert [item.name for item in ordered(items).items] == ["force", "plant", "out"]


def test_thousands_of_equations_are_sorted_at_once() -> None:
    items = [equation(str(k), str(k + 1)) for k in range(20_000)]
    assert ordered(items).items[0] == items[-1]
    loop = [equation(str(k), str((k + 1) % 5_000)) for k in range(5_000)]
    assert len(ordered(loop).loops[0]) == 5_000
