"""Restrictions of a system: each of their runs is a run of the system, but not the other way round."""

from __future__ import annotations

from collections.abc import Callable

from cspdiag.base.record import replaced
from cspdiag.network.dump.delay import is_of_time_out
from cspdiag.proofs.transitions.systems.system import INTERNAL, Event, System


def without(system: System, is_left_out: Callable[[Event], bool]) -> System:
    """The same components and events, of which some never happen."""
    gone = {number for number, event in enumerate(system.events) if is_left_out(event)}
    components = tuple(
        replaced(
            component,
            edges=tuple(
                tuple(edge for edge in edges if edge[0] == INTERNAL or edge[0] not in gone) for edges in component.edges
            ),
        )
        for component in system.components
    )
    return replaced(system, components=components)


def with_maximal_progress(system: System) -> System:
    """The same components and events, but a time-out happens only when no component is ready for another guard of the
    same alternative ("maximal progress").

    All components that could be ready for one are parties to the time-out, too, after the process that it belongs to;
    they stay in their states.
    """
    offered = [[{event for event, _ in edges} for edges in component.edges] for component in system.components]
    events = list(system.events)
    added: dict[int, list[tuple[int, int]]] = {}
    for number, event in enumerate(system.events):
        if not is_time_out(event):
            continue
        owner = event.parties[0]
        beside = {other for here in offered[owner] if number in here for other in here if other != INTERNAL}
        partners = sorted({party for other in beside for party in system.events[other].parties} - {owner})
        events[number] = replaced(event, parties=(owner, *partners))
        for partner in partners:
            added.setdefault(partner, []).extend(
                (state, number) for state, here in enumerate(offered[partner]) if not here & beside
            )
    components = list(system.components)
    for partner, loops in added.items():
        edges = [list(known) for known in components[partner].edges]
        for state, number in loops:
            edges[state].append((number, state))
        components[partner] = replaced(components[partner], edges=tuple(map(tuple, edges)))
    return replaced(system, components=tuple(components), events=tuple(events))


def is_time_out(event: Event) -> bool:
    """Whether an event is the end of an ``after``."""
    return event.kind == "time" and is_of_time_out(event.channel)
