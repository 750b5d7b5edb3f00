"""Which events can happen again and again without others: what the loops of the components say about it, without a
search.
"""

from __future__ import annotations

from collections.abc import Iterable

from cspdiag.base.graphs import strong_components
from cspdiag.base.record import replaced
from cspdiag.proofs.transitions.systems.system import INTERNAL, Component, Edge, System


def looping_part(system: System, events: Iterable[int]) -> System | None:
    """The system with only the edges that a cycle of these events and of internal steps can consist of; None if there
    is none.

    In a cycle of global states every component that moves returns to its state: all its edges lie in one strongly
    connected component of its own graph. An event that has no such edge in one of its parties is not part of a cycle,
    and without it others may not be.
    """
    components = system.components
    kept = set(events) | {INTERNAL}
    while True:
        components = tuple(_looping(component, kept) for component in components)
        left = {
            number
            for number in kept - {INTERNAL}
            if all(_offers(components[party], number) for party in system.events[number].parties)
        } | {INTERNAL}
        if left == kept:
            break
        kept = left
    if not any(any(component.edges) for component in components):
        return None
    return replaced(system, components=components)


def _looping(component: Component, events: set[int]) -> Component:
    """The component with only the edges with these events that lie on cycles of such edges."""
    edges: list[list[Edge]] = [[edge for edge in offered if edge[0] in events] for offered in component.edges]
    if not any(edges):
        return component if not any(component.edges) else replaced(component, edges=((),) * len(edges))
    part: dict[int, int] = {}
    for number, members in enumerate(
        strong_components(range(len(edges)), lambda state: [target for _, target in edges[state]])
    ):
        part.update(dict.fromkeys(members, number))
    return replaced(
        component,
        edges=tuple(
            tuple(edge for edge in offered if part[edge[1]] == part[state]) for state, offered in enumerate(edges)
        ),
    )


def _offers(component: Component, event: int) -> bool:
    return any(offered == event for edges in component.edges for offered, _ in edges)
