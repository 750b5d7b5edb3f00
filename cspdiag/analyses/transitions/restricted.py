"""A system without some of its events: what it does, the whole does too; what it does not do says nothing about the whole."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from cspdiag.analyses.transitions.system import INTERNAL, Event, System


def without(system: System, is_left_out: Callable[[Event], bool]) -> System:
    """The same components and events; those that are left out never happen."""
    gone = {number for number, event in enumerate(system.events) if is_left_out(event)}
    components = tuple(
        replace(
            component,
            edges=tuple(
                tuple(edge for edge in edges if edge[0] == INTERNAL or edge[0] not in gone) for edges in component.edges
            ),
        )
        for component in system.components
    )
    return replace(system, components=components)
