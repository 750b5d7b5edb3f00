"""Deadlocks and knots in one global state.

A **knot** is a non-empty set of components that wait for each other for ever, whatever the others do: no member has an internal edge, every event that a
member offers has another party in the set that does not offer it, and some member is a process that has not ended and offers an event. A controller has many
loops; one that runs on hides a deadlock of all the others, but not their knot.
"""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.analyses.transitions.system import INTERNAL, System


def enabled_events(system: System, state: Sequence[int]) -> list[int]:
    """The events that can happen in a global state, in increasing order."""
    willing: dict[int, int] = {}
    for component, local in zip(system.components, state, strict=True):
        for event in {event for event, _ in component.edges[local] if event != INTERNAL}:
            willing[event] = willing.get(event, 0) + 1
    return sorted(event for event, count in willing.items() if count == len(system.events[event].parties))


def is_deadlock(system: System, state: Sequence[int]) -> bool:
    """Whether nothing can happen in a global state, and not every process has ended."""
    if all(
        local in component.terminal or not component.process
        for component, local in zip(system.components, state, strict=True)
    ):
        return False
    if any(
        event == INTERNAL
        for component, local in zip(system.components, state, strict=True)
        for event, _ in component.edges[local]
    ):
        return False
    return not enabled_events(system, state)


def stuck_set(system: System, state: Sequence[int]) -> frozenset[int]:
    """The greatest knot in a global state: the components (indices) that never go on; empty if there is none."""
    offers = [
        frozenset(event for event, _ in component.edges[local])
        for component, local in zip(system.components, state, strict=True)
    ]
    refusing: dict[int, set[int]] = {}
    for offered in offers:
        for event in offered:
            if event != INTERNAL and event not in refusing:
                refusing[event] = {party for party in system.events[event].parties if event not in offers[party]}
    stuck = set(range(len(offers)))
    released = [
        index
        for index, offered in enumerate(offers)
        if any(event == INTERNAL or not refusing[event] for event in offered)
    ]
    stuck.difference_update(released)
    refused_by: list[list[int]] = [[] for _ in offers]
    for event, parties in refusing.items():
        for party in parties:
            refused_by[party].append(event)
    while released:
        for event in refused_by[released.pop()]:
            if not any(party in stuck for party in refusing[event]):
                freed = [party for party in system.events[event].parties if party in stuck and event in offers[party]]
                stuck.difference_update(freed)
                released += freed
    if any(
        offers[index] and system.components[index].process and state[index] not in system.components[index].terminal
        for index in stuck
    ):
        return frozenset(stuck)
    return frozenset()
