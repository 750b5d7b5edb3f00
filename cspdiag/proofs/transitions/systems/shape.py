"""A template with its labels numbered, and without the states before a start that always comes first."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from cspdiag.base.graphs import reached
from cspdiag.proofs.transitions.systems.labels import INTERNAL, Fork, Label, Start
from cspdiag.proofs.transitions.systems.references import ParallelId
from cspdiag.proofs.transitions.systems.template import PlaceTemplate, Template


class Shape:
    """The state machine of a thread. ``started`` says that the thread has been started when the system begins; labels
    in ``never`` do not happen.

    ``forked_at_once`` are the parallels that a started thread has started as well: it can do nothing before that, and
    never returns to that state.
    """

    def __init__(self, template: Template, *, started: bool, never: frozenset[Label] = frozenset()) -> None:
        edges = template.edges
        if never:
            edges = _without(edges, never)
        initial = 0
        if started and edges[0] and edges[0][0][0] == Start():
            initial = edges[0][0][1]
        self.forked_at_once: list[ParallelId] = []
        while started and len(edges[initial]) == 1:
            ((label, target),) = edges[initial]
            if not isinstance(label, Fork) or initial in _reached(edges, target):
                break
            self.forked_at_once.append(label.parallel)
            initial = target
        order = _reached(edges, initial)
        numbers = {state: number for number, state in enumerate(order)}
        labels: dict[Label, int] = {}
        self.edges: list[list[tuple[int, int]]] = [
            [(labels.setdefault(label, len(labels)), numbers[target]) for label, target in edges[state]]
            for state in order
        ]
        self.labels: list[Label] = list(labels)
        self.label_numbers = labels
        self.terminal = frozenset(numbers[state] for state in template.terminal if state in numbers)
        self.places: list[PlaceTemplate] = [template.places[state] for state in order]


def _without(edges: Sequence[Sequence[tuple[Label, int]]], never: frozenset[Label]) -> list[list[tuple[Label, int]]]:
    """The edges without what never happens. States of which only an internal edge remains are skipped."""
    left = [[edge for edge in found if edge[0] not in never] for found in edges]
    past = {
        state: after[0][1]
        for state, (before, after) in enumerate(zip(edges, left, strict=True))
        if len(after) == 1 < len(before) and after[0][0] == INTERNAL
    }
    return [[(label, _past(past, target)) for label, target in found] for found in left]


def _past(past: Mapping[int, int], state: int) -> int:
    seen = {state}
    while state in past and past[state] not in seen:
        state = past[state]
        seen.add(state)
    return state


def _reached(edges: Sequence[Sequence[tuple[Label, int]]], start: int) -> list[int]:
    """The reachable states in the order in which they are found, ``start`` first."""
    return list(reached([start], lambda state: [target for _, target in edges[state]]))
