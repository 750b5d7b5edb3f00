"""A transition system as text, for ``--emit lts``: components with their states and edges, each edge with its event.

The same network always gives the same text.
"""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.proofs.transitions.systems.system import INTERNAL, Component, Event, System


def dump(system: System) -> str:
    """The listing."""
    return "\n".join(_lines(system)) + "\n"


def _lines(system: System) -> Iterator[str]:
    states = sum(len(component.edges) for component in system.components)
    yield (
        f"// {_counted(len(system.components), 'component')} with {_counted(states, 'state')}, "
        f"{_counted(len(system.events), 'event')}"
    )
    for abstraction in system.abstractions:
        where = "" if abstraction.span is None else f" at {abstraction.span}"
        yield f"// left open: {abstraction.what}{where}"
    for component in system.components:
        yield ""
        yield from _component(component, system)


def _counted(number: int, what: str) -> str:
    return f"{number} {what}" if number == 1 else f"{number} {what}s"


def _component(component: Component, system: System) -> Iterator[str]:
    yield f"{'process' if component.process else 'medium'} {component.name} {{"
    for state, edges in enumerate(component.edges):
        marks = " initial" * (state == component.initial) + " terminal" * (state in component.terminal)
        place = component.places.get(state)
        words = "" if place is None else f" // {place.words}{'' if place.span is None else f' at {place.span}'}"
        yield f"  state {state}{marks}{words}"
        for event, target in edges:
            yield (
                f"    {'internal' if event == INTERNAL else _event(system.events[event], component, system)} -> "
                f"{target}"
            )
    yield "}"


def _event(event: Event, component: Component, system: System) -> str:
    others = [system.components[party].name for party in event.parties]
    others.remove(component.name)
    partners = (
        f" with {', '.join(others[:4])}{f' and {len(others) - 4} more' if len(others) > 4 else ''}" if others else ""
    )
    return f"{event.kind}{' visible' if event.visible else ''} {event}{partners}"
