"""Traps: sets of places that stay marked once one of them is marked.

A place is a state of a component; it is marked while the component is in that state. Every step that takes a component
out of a trap takes one into it, so a trap that contains an initial state always contains a current one: "the token is
somewhere on the ring". Traps exclude states that the analysis of pairs cannot exclude (Esparza and Melzer,
"Verification of safety properties using integer programming", 2000).
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from functools import cached_property
from typing import TypeAlias

from cspdiag.proofs.structure.pairs import Structure
from cspdiag.proofs.transitions.systems.system import INTERNAL

Place: TypeAlias = tuple[int, int]
"""A component and one of its states."""


class Traps:
    """The traps of one system. A step of several components counts as possible if each of them could take its part."""

    def __init__(self, structure: Structure) -> None:
        self.structure = structure
        self.first: list[int] = []
        total = 0
        for shape in structure.shapes:
            self.first.append(total)
            total += len(shape.edges)
        self.total = total
        self.initial = [first + shape.initial for first, shape in zip(self.first, structure.shapes, strict=True)]
        self._index_edges()

    def _index_edges(self) -> None:
        """Numbers the pairs of an event and a party, and lists the edges into every place."""
        self.into: list[list[tuple[int, int]]] = [[] for _ in range(self.total)]
        self.roles: list[int] = []  # The event of each pair of an event and a party, -1 for internal edges.
        self.parties = [len(event.parties) for event in self.structure.system.events]
        for first, shape, events in zip(self.first, self.structure.shapes, self.structure.events, strict=True):
            base = len(self.roles)
            self.roles += events
            for state in shape.reachable:
                for event, after in shape.edges[state]:
                    role = -1 if event == INTERNAL or event in shape.alone else base + event
                    self.into[first + after].append((role, first + state))

    def avoiding(self, state: Sequence[int]) -> list[Place] | None:
        """The largest trap with an initial place and without a place of the given global state; None if there is no
        such trap.
        """
        inside = bytearray(b"\x01") * self.total
        for first, local in zip(self.first, state, strict=True):
            inside[first + local] = 0
        return self._largest(inside)

    def smaller(self, trap: Collection[Place]) -> list[Place]:
        """A smaller trap within a trap, found by leaving out one component after another."""
        kept = list(trap)
        for component in sorted({component for component, _ in kept}):
            rest = [place for place in kept if place[0] != component]
            inside = bytearray(self.total)
            for one, state in rest:
                inside[self.first[one] + state] = 1
            found = self._largest(inside)
            if found is not None:
                kept = found
        return kept

    def _largest(self, inside: bytearray) -> list[Place] | None:
        """The largest trap within the places that are 1 in ``inside``; None if it has no initial place. Raises
        LimitError.
        """
        self.structure.limits.check()
        leaving: dict[int, list[int]] = {}  # The places from which each pair of event and party leaves the set.
        missing = self.parties.copy()  # The parties of each event that cannot leave the set yet.
        gone = [place for place in range(self.total) if not inside[place]]
        while gone:
            for role, source in self.into[gone.pop()]:
                if role < 0:
                    drop = [source]
                else:
                    event = self.roles[role]
                    sources = leaving.get(role)
                    if sources is not None:
                        sources.append(source)
                        drop = [source] if not missing[event] else []
                    else:
                        leaving[role] = [source]
                        missing[event] -= 1
                        drop = [] if missing[event] else self._sources(event, leaving)
                for place in drop:
                    if inside[place]:
                        inside[place] = 0
                        gone.append(place)
        if not any(inside[place] for place in self.initial):
            return None
        return [
            (component, state)
            for component, (first, shape) in enumerate(zip(self.first, self.structure.shapes, strict=True))
            for state in shape.reachable
            if inside[first + state]
        ]

    def _sources(self, event: int, leaving: dict[int, list[int]]) -> list[int]:
        return [place for role in self._roles_of[event] for place in leaving[role]]

    @cached_property
    def _roles_of(self) -> list[list[int]]:
        roles: list[list[int]] = [[] for _ in self.parties]
        for role, event in enumerate(self.roles):
            roles[event].append(role)
        return roles
