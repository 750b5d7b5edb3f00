"""The relations found in one traversal are those found by comparing every two communications."""

from __future__ import annotations

from hypothesis import given, settings

from cspdiag.network.infer.ends import ReadingEnds
from cspdiag.network.ir.actions import ReadValue
from cspdiag.network.ir.walk import all_actions
from tests.network.compositions import Leaf, Node, program, relations, text_of, trees
from tests.network.programs import shape_of


@settings(max_examples=60, deadline=None)
@given(trees("?!"))
def test_relations_are_those_of_all_pairs(tree: Leaf | Node) -> None:
    leaves: list[Leaf] = []
    composition = text_of(tree, leaves)
    shape, analysis = shape_of(program(composition, len(leaves)))
    expected = relations(tree)
    use = analysis.relations.of(shape)["c"]
    assert (use.parallel is not None) == (("!", "?", "parallel") in expected)
    assert (use.sequential is not None) == (("!", "?", "sequence") in expected)
    assert (use.parallel_writes is not None) == (("!", "!", "parallel") in expected)
    assert (use.parallel_reads is not None) == (("?", "?", "parallel") in expected)


def _parallel_pairs(tree: Leaf | Node) -> set[tuple[int, int]]:
    """Positions of leaves that are in parallel."""
    pairs: set[tuple[int, int]] = set()
    count = 0

    def positions(part: Leaf | Node) -> list[int]:
        nonlocal count
        if isinstance(part, Leaf):
            count += 1
            return [count - 1]
        inside = [positions(inner) for inner in part.parts]
        if part.operator == "||":
            for place, left in enumerate(inside):
                for right in inside[place + 1 :]:
                    pairs.update((one, other) for one in left for other in right)
        return [position for group in inside for position in group]

    positions(tree)
    return pairs


@settings(max_examples=60, deadline=None)
@given(trees("?"))
def test_parallel_readers_have_ends_of_their_own(tree: Leaf | Node) -> None:
    leaves: list[Leaf] = []
    composition = text_of(tree, leaves)
    shape, _ = shape_of(program(composition, len(leaves)))
    assert shape.body is not None
    ends = ReadingEnds(shape)
    reads = [action for action in all_actions(shape.body) if isinstance(action, ReadValue)]
    assigned = [ends.of_communication[id(action)] for action in reads]
    parallel = _parallel_pairs(tree)
    for one, other in parallel:
        assert assigned[one] != assigned[other]
    assert set(assigned) == set(range(ends.count["c"]))
    if not parallel:
        assert set(assigned) == {0}


def test_a_submodel_that_reads_one_port_twice_has_two_ends() -> None:
    shape, _ = shape_of("""
submodel Sum { in a, b : double  out y : double  y = a + b }
process Main {
  in  x : double @ 1 ms
  out y : double @ 1 ms
  communication {
    sum : Sum
    x -> sum.a, sum.b
    sum.y -> y
  }
  composition { mu sum }
}
""")
    ends = ReadingEnds(shape)
    assert {ends.of_input["sum", ("a", None)], ends.of_input["sum", ("b", None)]} == {0, 1}
    assert ends.count["x"] == 2


def test_an_instance_that_runs_at_several_places_keeps_its_end() -> None:
    """``a`` runs in parallel with ``b`` and later with ``c``: no end is shared by two that run at the same time."""
    shape, _ = shape_of("""
submodel Law { in u : double  out y : double  y = u }
process Main {
  in  x : double @ 1 ms
  communication {
    a : Law
    b : Law
    c : Law
    x -> a.u, b.u, c.u
    a.y -> _
    b.y -> _
    c.y -> _
  }
  composition { c ; (b || a) ; (a || c) }
}
""")
    ends = ReadingEnds(shape).of_input
    a, b, c = (ends[name, ("u", None)] for name in "abc")
    assert a not in (b, c)
