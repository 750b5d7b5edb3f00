"""The marking equation of a network, which decides for which weights of its places no step increases their sum."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

from cspdiag.base.record import record
from cspdiag.proofs.structure.pairs import Structure
from cspdiag.proofs.transitions.systems.system import INTERNAL

Weights: TypeAlias = dict[int, dict[int, int]]
"""The weights of the states of each component; a missing weight is 0."""


@record
class Problem:
    """A marking equation. Places are numbered; ``places[i]`` maps the states of component ``i`` to their places.

    ``free`` are the changes (from a place, to a place) that a component makes alone; ``events`` has, for each event and
    party, the changes of that party: each party makes one of its changes when the event happens. Initial places have
    weight 0: only differences within a component matter.
    """

    initial: tuple[int, ...]
    places: tuple[dict[int, int], ...]
    free: tuple[tuple[int, int], ...]
    events: tuple[tuple[tuple[tuple[int, int], ...], ...], ...]

    @property
    def size(self) -> int:
        """The number of changes."""
        return len(self.free) + sum(len(changes) for event in self.events for changes in event)

    def by_state(self, values: Sequence[int]) -> Weights:
        """Weights of places as weights of states, relative to the initial state of each component."""
        weights: Weights = {}
        for component, (start, places) in enumerate(zip(self.initial, self.places, strict=True)):
            base = values[places[start]]
            if weight := {state: values[place] - base for state, place in places.items() if values[place] != base}:
                weights[component] = weight
        return weights

    def never_increases(self, weights: Weights) -> bool:
        """Whether no step increases the sum of the weights; computed exactly, with whole numbers."""
        values: dict[int, int] = {}
        for component, weight in weights.items():
            values.update((self.places[component][state], value) for state, value in weight.items())

        def increase(change: tuple[int, int]) -> int:
            return values.get(change[1], 0) - values.get(change[0], 0)

        return all(increase(change) <= 0 for change in self.free) and all(
            sum(max(map(increase, changes)) for changes in event) <= 0 for event in self.events
        )

    def excess(self, weights: Weights, state: Sequence[int]) -> int:
        """By how much the sum of the weights in a global state exceeds that in the initial state."""
        return sum(weight.get(state[component], 0) for component, weight in weights.items())


def problem_of(structure: Structure) -> Problem:
    """The marking equation of a system."""
    places: list[dict[int, int]] = []
    free: list[tuple[int, int]] = []
    changes: list[dict[int, list[tuple[int, int]]]] = [{} for _ in structure.system.events]
    count = 0
    for component, (shape, events) in enumerate(zip(structure.shapes, structure.events, strict=True)):
        numbers = {state: count + at for at, state in enumerate(shape.reachable)}
        count += len(numbers)
        places.append(numbers)
        for state, number in numbers.items():
            for event, after in shape.edges[state]:
                change = (number, numbers[after])
                if event == INTERNAL or event in shape.alone:
                    free.append(change)
                else:
                    changes[events[event]].setdefault(component, []).append(change)
    joint = tuple(
        tuple(tuple(of_party) for of_party in parties.values())
        for parties, event in zip(changes, structure.system.events, strict=True)
        # An event that a party never offers never happens.
        if len(parties) == len(event.parties) > 1
    )
    return Problem(tuple(shape.initial for shape in structure.shapes), tuple(places), tuple(free), joint)
