"""Systems that do a part of what a whole does: what they do, the whole does too; what they do not do says nothing about
the whole.
"""

from __future__ import annotations

from collections.abc import Callable

from cspdiag.base.record import replaced
from cspdiag.network.dump.delay import is_of_time_out
from cspdiag.proofs.transitions.systems.system import INTERNAL, Event, System


def without(system: System, is_left_out: Callable[[Event], bool]) -> System:
    """The same components and events; those that are left out never happen."""
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


def prompt(system: System) -> System:
    """The same components and events, but that a time-out comes only when nobody is ready for another guard beside it.

    All who could be are parties to it too, after the process whose time-out it is; they stay where they are.
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
    """Whether it is the end of an ``after``."""
    return event.kind == "time" and is_of_time_out(event.channel)
