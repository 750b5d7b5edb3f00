"""States are merged exactly if they cannot be distinguished."""

from __future__ import annotations

from cspdiag.proofs.transitions.systems.minimal import minimized
from cspdiag.proofs.transitions.systems.template import Label, PlaceTemplate, Template

A: Label = ("time", "a")
B: Label = ("time", "b")
HERE, THERE = PlaceTemplate("here"), PlaceTemplate("there")


def template(edges: list[list[tuple[Label, int]]], places: list[PlaceTemplate], terminal: set[int]) -> Template:
    return Template(edges=edges, places=places, terminal=terminal)


def test_equivalent_states_are_merged() -> None:
    found = minimized(
        template([[(A, 1), (B, 2)], [(A, 3)], [(A, 4)], [], []], [HERE, THERE, THERE, HERE, HERE], {3, 4})
    )
    assert found.edges == [[(A, 1), (B, 1)], [(A, 2)], []]
    assert found.terminal == {2}


def test_states_of_other_words_are_kept_apart() -> None:
    found = minimized(template([[(A, 1), (B, 2)], [], []], [HERE, HERE, THERE], set()))
    assert len(found.edges) == 3


def test_terminal_states_are_kept_apart() -> None:
    found = minimized(template([[(A, 1), (B, 2)], [], []], [HERE, THERE, THERE], {2}))
    assert len(found.edges) == 3


def test_states_that_differ_only_later_are_kept_apart() -> None:
    chain: list[list[tuple[Label, int]]] = [[(A, 1), (B, 2)], [(A, 3)], [(A, 4)], [(A, 5)], [(B, 5)], []]
    assert len(minimized(template(chain, [HERE] * 6, set())).edges) == 6
