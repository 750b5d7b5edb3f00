"""Makes a system that has a deadlock if and only if the given one has a knot.

At any time each component may stop, and then either is guessed to be stuck or is ignored. The others continue without
it, which they could do anyway. An ignored component takes part in every event that another one requests, but in a
failure only if it offered it. A component that is guessed to be stuck requests all events that it offers; if one of
them happens the guess was wrong, and the component loops forever. In a state in which nothing is possible, those that
request events are a knot.
"""

from __future__ import annotations

from cspdiag.proofs.transitions.systems.system import INTERNAL, Component, Edge, Event, System
from cspdiag.proofs.verdict import Limits

_BYTES_PER_EDGE = 72
"""The size of a tuple of two numbers, in a tuple."""


def knots_as_deadlocks(system: System, limits: Limits) -> System:
    """The system, with an additional event for each party of each event: it happens after the components have stopped,
    at the request of that party. Raises LimitError.
    """
    events = list(system.events)
    asked: list[dict[int, int]] = []
    for event in system.events:
        asked.append({})
        if len(event.parties) > 1:
            for party in event.parties:
                asked[-1][party] = len(events)
                events.append(Event(event.channel, event.parties))
    alphabets: list[set[int]] = [set() for _ in system.components]
    for number, event in enumerate(system.events):
        for party in event.parties:
            alphabets[party].add(number)
    components = []
    edges = 0
    for at, component in enumerate(system.components):
        limits.check(edges * _BYTES_PER_EDGE)
        components.append(_stopping(component, at, sorted(alphabets[at]), asked, system.events))
        edges += sum(map(len, components[-1].edges))
    return System(tuple(components), tuple(events))


def _stopping(
    component: Component, at: int, alphabet: list[int], asked: list[dict[int, int]], events: tuple[Event, ...]
) -> Component:
    """The component with further states: those in which it is guessed to be stuck, those in which it is ignored, and
    one that loops forever.
    """
    count = len(component.edges)
    looping = 3 * count
    running = tuple(
        (*edges, (INTERNAL, count + state), (INTERNAL, 2 * count + state))
        for state, edges in enumerate(component.edges)
    )
    stuck = tuple(
        tuple(dict.fromkeys(edge for event, _ in edges for edge in _refutations_of_stuck(event, asked, looping)))
        for edges in component.edges
    )
    left_out = tuple(
        tuple(
            (happens, 2 * count + state)
            for known in alphabet
            if events[known].kind != "failure" or any(event == known for event, _ in edges)
            for party, happens in asked[known].items()
            if party != at
        )
        for state, edges in enumerate(component.edges)
    )
    content = {count + state for state, edges in enumerate(component.edges) if state in component.terminal or not edges}
    return Component(
        component.name,
        (*running, *stuck, *left_out, ((INTERNAL, looping),)),
        frozenset(content | set(range(2 * count, 3 * count))),
        component.initial,
        process=component.process,
    )


def _refutations_of_stuck(event: int, asked: list[dict[int, int]], looping: int) -> list[Edge]:
    """The edges that show that a component which offers an event is not stuck."""
    if event == INTERNAL or not asked[event]:
        return [(INTERNAL, looping)]
    return [(happens, looping) for happens in asked[event].values()]
