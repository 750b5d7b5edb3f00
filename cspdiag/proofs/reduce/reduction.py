"""Composes processes two at a time; events between the two are hidden, and each result is minimized.

The pair with the smallest expected result comes next (Graf and Steffen, "Compositional minimization of finite state
systems", 1990; Crouzen and Lang, "Smart reduction", 2011). Identical pairs are composed once.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from heapq import heapify, heappop, heappush
from math import prod

from cspdiag.base.record import replaced
from cspdiag.proofs.reduce.parallel_machines import MachineInSystem, Pairs, TooLargeError, part_of
from cspdiag.proofs.transitions.systems.system import INTERNAL, Component, System
from cspdiag.proofs.verdict import Limits

_MOST_GIVEN_UP = 10
"""After this number of pairs that were too large no further pair is tried."""

_WORTH_WHILE = 1_000_000
"""Systems with more states than this are reduced before all states are explored."""

_OUTSIDE = -1
"""A party of all kept events that is never composed with others."""


def seen_from_outside(system: System, kept: Collection[int], limits: Limits) -> System | None:
    """An equivalent system with only the kept events, which also has the same refusals and livelocks; None if it is too
    large. Raises LimitError.
    """
    reduction = Reduction(system, limits, kept)
    parts = list(reduction.remaining())
    if reduction.too_large:
        return None
    number = {event: at for at, event in enumerate(sorted(kept))}
    owner = {event: at for at, part in enumerate(parts) for event in part.events}
    components = tuple(_component(part, at, number) for at, part in enumerate(parts))
    events = tuple(replaced(system.events[event], parties=(owner[event],)) for event in sorted(kept))
    return System(components, events)


def can_livelock(reduced: System) -> bool:
    """Whether a minimized system has an internal loop, the only remaining cycles of internal steps."""
    return any(
        (INTERNAL, state) in edges for component in reduced.components for state, edges in enumerate(component.edges)
    )


def is_large(system: System) -> bool:
    """Whether it is worthwhile to reduce the system before all its states are explored."""
    return prod(len(component.edges) for component in system.components) > _WORTH_WHILE


def _component(part: MachineInSystem, at: int, number: dict[int, int]) -> Component:
    edges = tuple(
        tuple((INTERNAL if event == INTERNAL else number[part.events[event]], target) for event, target in offered)
        for offered in part.machine.edges
    )
    ended = frozenset(state for state, ended in enumerate(part.machine.ended) if ended)
    return Component(f"part {at}", edges, ended)


class Reduction:
    """Composes the components of a system, its first parts, until no two parts share an event.

    ``kept`` events are not hidden, because they are visible outside; with ``only_deadlocks`` the result is equivalent
    only as to deadlocks.
    """

    def __init__(
        self, system: System, limits: Limits, kept: Collection[int] = (), *, only_deadlocks: bool = False
    ) -> None:
        self._limits = limits
        self._pairs = Pairs(limits, only_deadlocks)
        self.largest = 1
        self.too_large = False
        """Whether parts with common events are left because no two of them can be composed within the limits."""
        alphabets: list[set[int]] = [set() for _ in system.components]
        for event, known in enumerate(system.events):
            for party in known.parties:
                alphabets[party].add(event)
        alone = {event for event, known in enumerate(system.events) if len(known.parties) == 1 and event not in kept}
        self._parts = {
            at: self._pairs.minimal(part_of(component, alphabets[at], alone))
            for at, component in enumerate(system.components)
        }
        self._members: dict[int, set[int]] = {
            event: {*known.parties, _OUTSIDE} if event in kept else set(known.parties)
            for event, known in enumerate(system.events)
            if event not in alone
        }
        self._queue = []
        for one, other in sorted(self._neighbours()):
            limits.check()
            self._queue.append(self._ranked(one, other))
        heapify(self._queue)

    def remaining(self) -> Iterator[MachineInSystem]:
        """The parts that are left when no two of them share an event, or composing them is not worthwhile. Raises
        LimitError.
        """
        number = len(self._parts)
        given_up: set[tuple[int, int]] = set()
        while self._queue and len(given_up) < _MOST_GIVEN_UP:
            _, one, other = heappop(self._queue)
            if one not in self._parts or other not in self._parts:
                continue
            self._limits.check()
            try:
                self._put_together(one, other, number)
            except TooLargeError:
                given_up.add((one, other))
            number += 1
        self.too_large = any(len(members - {_OUTSIDE}) > 1 for members in self._members.values())
        yield from self._parts.values()

    def _put_together(self, one: int, other: int, number: int) -> None:
        first, second = self._parts[one], self._parts[other]
        events = {*first.events, *second.events}
        inside = {event for event in events if self._members[event] <= {one, other}}
        part = self._pairs.together(first, second, inside)
        del self._parts[one], self._parts[other]
        for event in inside:
            self._members[event].clear()
        for event in events - inside:
            self._members[event] -= {one, other}
            self._members[event].add(number)
        self._parts[number] = part
        self.largest = max(self.largest, len(part.machine.edges))
        for neighbour in {member for event in part.events for member in self._members[event]} - {number, _OUTSIDE}:
            heappush(self._queue, self._ranked(neighbour, number))

    def _neighbours(self) -> set[tuple[int, int]]:
        found: set[tuple[int, int]] = set()
        for members in self._members.values():
            for one in members - {_OUTSIDE}:
                self._limits.check()
                found.update((one, other) for other in members if one < other)
        return found

    def _ranked(self, one: int, other: int) -> tuple[tuple[float, int], int, int]:
        """The rank of a pair: pairs with few states, and with many events that only these two share, come first."""
        first, second = self._parts[one], self._parts[other]
        shared = set(first.events) & set(second.events)
        hidden = sum(self._members[event] <= {one, other} for event in shared)
        events = len(first.events) + len(second.events) - len(shared)
        states = len(first.machine.edges) * len(second.machine.edges)
        return (states * (1 - hidden / (events + 1)), events), one, other
