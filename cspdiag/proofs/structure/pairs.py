"""Which states two components that share an event can be in at the same time.

The composition of two components, with all other components taken to be willing, reaches every pair of states that the
whole network reaches, and few others: the abstraction of Antonino, Gibson-Robinson and Roscoe, "Efficient
deadlock-freedom checking using local analysis and SAT solving" (iFM 2016). Components that differ only in the names of
their events have the same **shape**, and pairs of the same shapes, joined in the same way, are explored once.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable
from functools import cached_property
from itertools import combinations
from typing import Any, NamedTuple, TypeAlias, TypeVar

from cspdiag.base.record import record
from cspdiag.proofs.structure.merging import representatives
from cspdiag.proofs.transitions.systems.system import INTERNAL, Component, Edge, System
from cspdiag.proofs.verdict import Limits

T = TypeVar("T")

Link: TypeAlias = tuple[int, int, bool, bool]
"""An event that two shapes share: its number in either, whether the two are its only parties, and whether it is a
failure.
"""

LARGEST_PRODUCT = 250_000
"""Pairs with more states than this are taken to reach all of them."""

LARGEST_MULTIWAY = 4
"""Any two parties of an event with at most this number of parties are a pair; of larger events only the first party
with each of the others.
"""


@record
class Shape:
    """A component with its events numbered from 0, in the order in which they occur.

    ``alone`` are the events with a single party, which no other component can refuse. States keep the numbers that they
    have in the component.
    """

    edges: tuple[tuple[Edge, ...], ...]
    alone: frozenset[int]
    terminal: frozenset[int]
    initial: int
    process: bool

    @cached_property
    def reachable(self) -> tuple[int, ...]:
        """The states that the component reaches if all partners are willing, in increasing order."""
        return tuple(sorted(self.depths))

    @cached_property
    def depths(self) -> dict[int, int]:
        """The least number of steps to each of those states."""
        depths, waiting = {self.initial: 0}, [self.initial]
        for state in waiting:
            for _, after in self.edges[state]:
                if after not in depths:
                    depths[after] = depths[state] + 1
                    waiting.append(after)
        return depths

    @cached_property
    def offers(self) -> tuple[tuple[int, ...], ...]:
        """For each state the events that it offers, each once."""
        return tuple(tuple(dict.fromkeys(event for event, _ in edges if event != INTERNAL)) for edges in self.edges)

    @cached_property
    def targets(self) -> tuple[dict[int, tuple[int, ...]], ...]:
        """For each state the states after each of its events."""
        found: list[dict[int, tuple[int, ...]]] = [{} for _ in self.edges]
        for targets, edges in zip(found, self.edges, strict=True):
            for event, after in edges:
                targets[event] = (*targets.get(event, ()), after)
        return tuple(found)

    @cached_property
    def after(self) -> tuple[dict[int, int], ...]:
        """For each state the states after it, with the number of edges that lead there."""
        found: list[dict[int, int]] = [{} for _ in self.edges]
        for after, edges in zip(found, self.edges, strict=True):
            for _, state in edges:
                after[state] = after.get(state, 0) + 1
        return tuple(found)

    def without(self, events: Collection[int]) -> list[list[int]]:
        """For each state the states after it by events other than these."""
        found = []
        for targets, after in zip(self.targets, self.after, strict=True):
            left = after
            for event in events:
                for state in targets.get(event, ()):
                    left = left.copy() if left is after else left
                    left[state] -= 1
            found.append([state for state, edges in left.items() if edges])
        return found

    @cached_property
    def waiting(self) -> tuple[int, ...]:
        """The reachable states that the component leaves only together with other components, or never."""
        return tuple(
            state
            for state in self.reachable
            if all(event != INTERNAL and event not in self.alone for event, _ in self.edges[state])
        )

    @cached_property
    def requesting(self) -> frozenset[int]:
        """The states in which a process that has not ended waits for an event: only a knot with such a state is
        reported.
        """
        if not self.process:
            return frozenset()
        return frozenset(state for state in self.waiting if self.edges[state] and state not in self.terminal)


class Pair:
    """Two shapes joined by events: ``reached[s]`` are the states that the second can be in while the first is in state
    ``s``, and ``reached_back`` the other way round.

    ``blocked[s]`` are those among them in which both wait and have no event together. ``first_requests`` are the states
    of the first in which it offers an event that only the second can refuse. A failure is not waited for; if the first
    takes part in a failure in state ``s``, ``first_without_failure[s]`` are the states of the second in which that
    failure is not possible.
    """

    def __init__(self, first: Shape, second: Shape, links: tuple[Link, ...], limits: Limits) -> None:
        self.complete = len(first.reachable) * len(second.reachable) <= LARGEST_PRODUCT
        self.reached = _reached(first, second, links, limits) if self.complete else _all(first, second)
        self.reached_back = _transposed(self.reached)
        self.blocked = _blocked(first, second, links, self.reached)
        self.blocked_back = _transposed(self.blocked)
        self.first_requests = _requested(first, [own for own, _, only, fails in links if only and not fails])
        self.second_requests = _requested(second, [other for _, other, only, fails in links if only and not fails])
        failures = [(own, other) for own, other, only, fails in links if only and fails]
        self.first_without_failure = _without_failure(first, second, failures, self.reached)
        self.second_without_failure = _without_failure(
            second, first, [(other, own) for own, other in failures], self.reached_back
        )
        self.first_never_blocked = tuple(state for state in first.waiting if not self.blocked.get(state))
        self.second_never_blocked = tuple(state for state in second.waiting if not self.blocked_back.get(state))

    def seen_from_first(self, second: int) -> Neighbour:
        """The pair from the first's point of view, with component ``second`` as its neighbour."""
        return Neighbour(
            second, self.reached, self.blocked, self.blocked_back,
            self.first_requests, self.second_requests, self.first_never_blocked, self.first_without_failure,
            self.complete,
        )  # fmt: skip

    def seen_from_second(self, first: int) -> Neighbour:
        """The pair from the second's point of view, with component ``first`` as its neighbour."""
        return Neighbour(
            first, self.reached_back, self.blocked_back, self.blocked,
            self.second_requests, self.first_requests, self.second_never_blocked, self.second_without_failure,
            self.complete,
        )  # fmt: skip


def _all(first: Shape, second: Shape) -> dict[int, tuple[int, ...]]:
    return dict.fromkeys(first.reachable, second.reachable)


def _reached(first: Shape, second: Shape, links: tuple[Link, ...], limits: Limits) -> dict[int, tuple[int, ...]]:
    shared = [(own, other) for own, other, *_ in links]
    first_alone, second_alone = (
        first.without([own for own, _ in shared]),
        second.without([other for _, other in shared]),
    )
    found = {(first.initial, second.initial)}
    waiting = [(first.initial, second.initial)]
    while waiting:
        limits.check()
        one, two = waiting.pop()
        follow = [(after, two) for after in first_alone[one]]
        follow += [(one, after) for after in second_alone[two]]
        said, heard = first.targets[one], second.targets[two]
        for own, other in shared:
            if own in said and other in heard:
                follow += [(after, beside) for after in said[own] for beside in heard[other]]
        for state in follow:
            if state not in found:
                found.add(state)
                waiting.append(state)
    return _grouped(found)


def _blocked(
    first: Shape, second: Shape, links: tuple[Link, ...], reached: dict[int, tuple[int, ...]]
) -> dict[int, tuple[int, ...]]:
    partner = {own: other for own, other, only, _ in links if only}
    waiting = set(second.waiting)
    answer = {}
    for state in first.waiting:
        requested = {partner[event] for event in first.offers[state] if event in partner}
        others = (other for other in reached.get(state, ()) if other in waiting)
        answer[state] = tuple(other for other in others if second.targets[other].keys().isdisjoint(requested))
    return answer


def _requested(shape: Shape, shared: Iterable[int]) -> frozenset[int]:
    """The waiting states that offer an event that only the other shape of the pair can refuse."""
    wanted = set(shared)
    return frozenset(state for state in shape.waiting if not wanted.isdisjoint(shape.offers[state]))


def _without_failure(
    first: Shape, second: Shape, failures: list[tuple[int, int]], reached: dict[int, tuple[int, ...]]
) -> dict[int, tuple[int, ...]]:
    without_failure: dict[int, tuple[int, ...]] = {}
    for state in first.waiting if failures else ():
        partners = {other for own, other in failures if own in first.offers[state]}
        if partners:
            others = reached.get(state, ())
            without_failure[state] = tuple(
                other for other in others if second.targets[other].keys().isdisjoint(partners)
            )
    return without_failure


def _grouped(pairs: Iterable[tuple[int, int]]) -> dict[int, tuple[int, ...]]:
    groups: dict[int, list[int]] = {}
    for one, two in sorted(pairs):
        groups.setdefault(one, []).append(two)
    return {one: tuple(others) for one, others in groups.items()}


def _transposed(groups: dict[int, tuple[int, ...]]) -> dict[int, tuple[int, ...]]:
    return _grouped((two, one) for one, others in groups.items() for two in others)


class Neighbour(NamedTuple):
    """A neighbour of a component, which shares an event with it: the tables of ``Pair`` from the component's point of
    view.

    ``requests`` are the states of the component in which it waits for the neighbour alone, ``requested`` those of the
    neighbour in which it waits for the component alone; ``never_blocked`` are waiting states of the component in which
    the neighbour never waits for it at the same time; ``without_failure`` as in ``Pair``.
    """

    component: int
    reached: dict[int, tuple[int, ...]]
    blocked: dict[int, tuple[int, ...]]
    blocked_back: dict[int, tuple[int, ...]]
    requests: frozenset[int]
    requested: frozenset[int]
    never_blocked: tuple[int, ...]
    without_failure: dict[int, tuple[int, ...]]
    complete: bool


class Structure:
    """The shapes of a system: ``shapes[i]`` and ``events[i]`` (the events of the shape) of every component, and its
    neighbours.

    Of several merged events only one has parties here. ``limits`` apply to the exploration of pairs.
    """

    def __init__(self, system: System, limits: Limits | None = None) -> None:
        self.system = system
        self.limits = limits or Limits(math.inf)
        self._remembered: dict[str, Any] = {}
        self.shapes: list[Shape] = []
        self.events: list[tuple[int, ...]] = []
        alone = bytearray(len(event.parties) == 1 for event in system.events)
        known: dict[object, Shape] = {}
        self.merged = merged = representatives(system)
        roles: list[list[int]] = [[] for _ in system.components]
        for number, event in enumerate(system.events):
            if merged[number] == number:
                for party in event.parties:
                    roles[party].append(number)
        for component, expected in zip(system.components, roles, strict=True):
            shape, events = _shape(component, expected, merged, alone, known)
            self.shapes.append(shape)
            self.events.append(events)

    def cached(self, what: str, find: Callable[[], T]) -> T:
        """The result of the first call of ``find``, which must depend on the system alone."""
        if what not in self._remembered:
            self._remembered[what] = find()
        found: T = self._remembered[what]
        return found

    @cached_property
    def fails(self) -> bool:
        """Whether there are events of the kind ``failure``, which release a component from a knot only if they are
        possible now.
        """
        return any(event.kind == "failure" for event in self.system.events)

    @cached_property
    def roles(self) -> list[list[tuple[int, int]]]:
        """The parties of each event, in increasing order, each with the number of the event in its shape."""
        roles: list[list[tuple[int, int]]] = [[] for _ in self.system.events]
        for component, events in enumerate(self.events):
            for number, event in enumerate(events):
                roles[event].append((component, number))
        return roles

    @cached_property
    def neighbours(self) -> list[list[Neighbour]]:
        """The neighbours of each component. Raises LimitError."""
        links: dict[tuple[int, int], list[Link]] = {}
        for roles, event in zip(self.roles, self.system.events, strict=True):
            if len(roles) == 2:
                (first, own), (second, other) = roles
                links.setdefault((first, second), []).append((own, other, True, event.kind == "failure"))
            elif len(roles) <= LARGEST_MULTIWAY:
                for (first, own), (second, other) in combinations(roles, 2):
                    links.setdefault((first, second), []).append((own, other, False, False))
            else:
                hub = event.parties[0]
                of_hub = dict(roles)[hub]
                for party, number in roles:
                    if party < hub:
                        links.setdefault((party, hub), []).append((number, of_hub, False, False))
                    elif party > hub:
                        links.setdefault((hub, party), []).append((of_hub, number, False, False))
        pairs: dict[tuple[int, int, tuple[Link, ...]], Pair] = {}
        answer: list[list[Neighbour]] = [[] for _ in self.shapes]
        for (one, two), joined in links.items():
            key = (id(self.shapes[one]), id(self.shapes[two]), tuple(joined))
            pair = pairs.get(key)
            if pair is None:
                pair = pairs[key] = Pair(self.shapes[one], self.shapes[two], key[2], self.limits)
            answer[one].append(pair.seen_from_first(two))
            answer[two].append(pair.seen_from_second(one))
        return answer


def _shape(
    component: Component, expected: list[int], merged: list[int], alone: bytearray, known: dict[object, Shape]
) -> tuple[Shape, tuple[int, ...]]:
    """The shape of a component, and its events; the ``expected`` events that it never offers come last."""
    numbers: dict[int, int] = {INTERNAL: INTERNAL}
    renamed = tuple(
        tuple(
            dict.fromkeys(
                (event if event == INTERNAL else numbers.setdefault(merged[event], len(numbers) - 1), after)
                for event, after in edges
            )
        )
        for edges in component.edges
    )
    if len(numbers) <= len(expected):
        for event in expected:
            numbers.setdefault(event, len(numbers) - 1)
    events = tuple(numbers)[1:]
    lone = frozenset(number for number, event in enumerate(events) if alone[event])
    key = (renamed, len(events), lone, component.terminal, component.initial, component.process)
    shape = known.get(key)
    if shape is None:
        shape = known[key] = Shape(renamed, lone, component.terminal, component.initial, component.process)
    return shape, events
