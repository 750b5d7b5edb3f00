"""Which events can be repeated forever without others, as far as the loops of the components show it, without
a search.
"""

from __future__ import annotations

from collections.abc import Iterable

from cspdiag.base.graphs import strong_components
from cspdiag.base.record import replaced
from cspdiag.proofs.transitions.systems.system import INTERNAL, Component, Edge, System


def looping_part(system: System, events: Iterable[int]) -> System | None:
    """The system with only those edges that can be part of a cycle of these events and internal steps; None if it has
    none.

    In a cycle of global states every component that moves returns to its state: all its edges lie in one strongly
    connected component of its own graph. An event that has no such edge in one of its parties is not part of a cycle,
    and without it others may not be.
    """
    components = list(system.components)
    kept = set(events) | {INTERNAL}
    offered = [offered_by(component) for component in components]
    lost = {event for event in kept - {INTERNAL} if not _is_offered(system, event, offered)}
    changed: Iterable[int] = range(len(components))
    while changed:
        kept -= lost
        lost = set()
        for party in changed:
            components[party] = looping(components[party], kept)
            left = offered_by(components[party])
            lost |= (offered[party] - left) & kept
            offered[party] = left
        # The remaining edges of other components lie on cycles as before.
        changed = {party for event in lost for party in system.events[event].parties if event in offered[party]}
    if not any(any(component.edges) for component in components):
        return None
    return replaced(system, components=tuple(components))


def looping(component: Component, events: set[int]) -> Component:
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


def offered_by(component: Component) -> set[int]:
    """The events that a component offers in some state."""
    return {event for edges in component.edges for event, _ in edges if event != INTERNAL}


def _is_offered(system: System, event: int, offered: list[set[int]]) -> bool:
    return all(event in offered[party] for party in system.events[event].parties)
