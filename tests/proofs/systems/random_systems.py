"""Small random systems: few states, every kind of edge, so that deadlocks, knots and ends of all kinds occur."""

from __future__ import annotations

from random import Random

from cspdiag.proofs.transitions.systems.system import INTERNAL, Component, Event, EventKind, System


def random_system(seed: int) -> System:
    """A system of two to five components, the same for the same seed."""
    random = Random(seed)
    size = random.randint(2, 5)
    parties = [_parties(random, size) for _ in range(random.randint(size, 2 * size + 2))]
    ending = random.random() < 0.2
    make = _ending if ending else _component
    components = [
        make(random, at, [event for event, members in enumerate(parties) if at in members]) for at in range(size)
    ]
    used = [{event for edges in component.edges for event, _ in edges} - {INTERNAL} for component in components]
    events = [
        Event(f"e{event}", tuple(at for at in members if event in used[at]), _kind(random, members), None,
         random.random() < 0.3)
        for event, members in enumerate(parties)
    ]  # fmt: skip
    return _without_unused(System(tuple(components), tuple(events)))


def _parties(random: Random, size: int) -> list[int]:
    count = random.choices((1, 2, 3), weights=(2, 10, 1))[0]
    return sorted(random.sample(range(size), min(count, size)))


def _kind(random: Random, members: list[int]) -> EventKind:
    if len(members) > 1:
        return "failure" if random.random() < 0.1 else "communication"
    return random.choice(("external", "variable", "time", "sample"))


def _component(random: Random, at: int, events: list[int]) -> Component:
    states = random.randint(1, 5)
    cyclic = random.random() < 0.6
    edges: list[tuple[tuple[int, int], ...]] = []
    for state in range(states):
        choices = random.choices((0, 1, 2, 3), weights=(0 if cyclic else 2, 6, 4, 1))[0]
        found = []
        for _ in range(choices):
            event = INTERNAL if not events or random.random() < 0.12 else random.choice(events)
            target = (state + 1) % states if random.random() < 0.6 else random.randrange(states)
            found.append((event, target))
        edges.append(tuple(found))
    terminal = frozenset(state for state, offered in enumerate(edges) if random.random() < (0.05 if offered else 0.6))
    return Component(f"p{at}", tuple(edges), terminal, process=random.random() < 0.9)


def _ending(random: Random, at: int, events: list[int]) -> Component:
    """A component without cycles, usually with an end."""
    states = random.randint(2, 5)
    edges: list[tuple[tuple[int, int], ...]] = []
    for state in range(states - 1):
        found = [random.choice([INTERNAL, *events]) for _ in range(random.choice((1, 1, 2)))]
        edges.append(tuple((event, random.randint(state + 1, states - 1)) for event in found))
    terminal = {states - 1} if random.random() < 0.9 else set()
    terminal |= {state for state in range(states - 1) if random.random() < 0.2}
    return Component(f"p{at}", (*edges, ()), frozenset(terminal))


def _without_unused(system: System) -> System:
    kept = [at for at, event in enumerate(system.events) if event.parties]
    number = {at: new for new, at in enumerate(kept)} | {INTERNAL: INTERNAL}
    components = tuple(
        Component(
            component.name,
            tuple(tuple((number[event], target) for event, target in edges) for edges in component.edges),
            component.terminal,
            component.initial,
            process=component.process,
        )
        for component in system.components
    )
    return System(components, tuple(system.events[at] for at in kept))
