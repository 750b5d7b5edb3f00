"""Stubborn sets: sets of events of which only the possible ones need to be explored, because events outside the set
cannot interfere with them.

For each possible event in it, a set contains all events that may exclude it or be excluded by it, in any of its
parties; for each event that is not possible, all steps by which one party that refuses it can come to offer it
(Valmari, "The state explosion problem", 1998, section 7).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import product
from typing import TypeAlias

from cspdiag.base.graphs import reached, strong_components
from cspdiag.proofs.search.local_dependence import LocalDependence, Targets
from cspdiag.proofs.transitions.systems.system import INTERNAL, Edge, System
from cspdiag.proofs.verdict import Limits, Move

State: TypeAlias = tuple[int, ...]

Ready: TypeAlias = frozenset[int]
"""Components of which an event is possible: of those that an event has, the first one."""


class ClosedSets:
    """The stubborn sets of the states of a system. Internal steps are numbered after the events, one for each
    component.

    All methods may raise LimitError.
    """

    def __init__(self, system: System, limits: Limits | None = None) -> None:
        within = limits or Limits(math.inf)
        count = len(system.events)
        self._internal = count
        self._parties = [event.parties for event in system.events]
        self._parties += [(at,) for at in range(len(system.components))]
        self._targets = [
            [_targets(edges, count + at) for edges in component.edges] for at, component in enumerate(system.components)
        ]
        self._owned = [
            [
                [(event, self._parties[event][1:]) for event in targets if self._parties[event][0] == at]
                for targets in states
            ]
            for at, states in enumerate(self._targets)
        ]
        """For each component and state, the events of which the component is the first party, and their
        other parties.
        """
        self._owners = _owners(self._parties, len(system.components))
        self._local = [LocalDependence(states, within) for states in self._targets]

    def ready(self, state: State) -> Ready:
        """The components of which an event is possible in a state."""
        return frozenset([at for at in range(len(state)) if self._can(state, at)])

    def ready_after(self, ready: Ready, move: Move, after: State) -> Ready:
        """The same for the state after a move, where only the events of those that moved can have changed."""
        concerned = {owner for party, _ in move.moves for owner in self._owners[party]}
        now = {at for at in concerned if self._can(after, at)}
        return ready if now == concerned & ready else (ready - concerned) | now

    def _can(self, state: State, at: int) -> bool:
        return any(True for _ in self._possible(state, at))

    def _possible(self, state: State, at: int) -> Iterator[int]:
        targets = self._targets
        for event, partners in self._owned[at][state[at]]:
            for partner in partners:
                if event not in targets[partner][state[partner]]:
                    break
            else:
                yield event

    def possible(self, state: State, ready: Ready | None = None) -> Iterator[int]:
        """Every event that is possible in a state; ``ready`` are the components that have one, if they are known."""
        for at in range(len(state)) if ready is None else sorted(ready):
            yield from self._possible(state, at)

    def moves(self, state: State, event: int) -> Iterator[tuple[Move, State]]:
        """The moves with an event that are possible in a state, and the states after them."""
        parties = self._parties[event]
        for targets in product(*(self._targets[party][state[party]][event] for party in parties)):
            after = list(state)
            for party, target in zip(parties, targets, strict=True):
                after[party] = target
            moved = tuple(zip(parties, targets, strict=True))
            yield Move(event if event < self._internal else INTERNAL, moved), tuple(after)

    def smallest(self, state: State, ready: Ready | None = None) -> list[int]:
        """The possible events of the stubborn set with the fewest of them, at least one if any event is possible;
        ``ready`` as for `possible`.
        """
        interfering = _Interfering(self, state)
        possible = []
        for event in self.possible(state, ready):
            if not interfering(event):
                return [event]
            possible.append(event)
        if len(possible) < 2:
            return possible
        can = set(possible)
        best = possible
        can_step: set[int] = set()
        for component in strong_components(possible, interfering):
            if any(other in can_step for event in component for other in interfering(event)):
                can_step.update(component)
                continue
            events = [event for event in reversed(component) if event in can]
            if events:
                can_step.update(component)
                if len(events) < len(best):
                    best = events
        return best

    def closure(self, state: State, event: int) -> list[int]:
        """The possible events of the smallest stubborn set to which an event belongs."""
        interfering = _Interfering(self, state)
        members = set(reached([event], interfering))
        return [event for event in self.possible(state) if event in members]

    def interfering(self, state: State, event: int) -> tuple[int, ...]:
        """The events that directly belong to every stubborn set that contains this one."""
        parties = self._parties[event]
        for party in parties:
            if event not in self._targets[party][state[party]]:
                return self._local[party].enabling(state[party], event)
        if len(parties) == 1:
            return self._local[parties[0]].disturbing(state[parties[0]], event)
        return tuple({other: None for party in parties for other in self._local[party].disturbing(state[party], event)})


class _Interfering(dict[int, tuple[int, ...]]):
    """The events that interfere with each event in one state, each computed once."""

    def __init__(self, sets: ClosedSets, state: State) -> None:
        super().__init__()
        self._sets = sets
        self._state = state

    def __missing__(self, event: int) -> tuple[int, ...]:
        self[event] = found = self._sets.interfering(self._state, event)
        return found

    def __call__(self, event: int) -> tuple[int, ...]:
        return self[event]


def _owners(parties: Sequence[Sequence[int]], components: int) -> list[set[int]]:
    """For each component, those to which the events belong that it takes part in."""
    found: list[set[int]] = [set() for _ in range(components)]
    for of_event in parties:
        for party in of_event:
            found[party].add(of_event[0])
    return found


def _targets(edges: Sequence[Edge], internal: int) -> Targets:
    """The states after each event of one state."""
    found: Targets = {}
    for event, target in edges:
        number = internal if event == INTERNAL else event
        if target not in found.get(number, ()):
            found[number] = (*found.get(number, ()), target)
    return found
