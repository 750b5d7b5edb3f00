"""Recognizes the forms of processes that published design rules are about. They name the reason of a proof, and prove
nothing by themselves.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from cspdiag.proofs.structure.pairs import Shape, Structure
from cspdiag.proofs.transitions.systems.system import INTERNAL


def is_io_par(structure: Structure) -> bool:
    """Whether every component takes part in each of its shared events once a round, in any order (I/O-PAR; Welch, Justo
    and Willcock, 1993).
    """
    return _all_shapes(structure, _shares_all_at_once)


def _all_shapes(structure: Structure, has_form: Callable[[Shape], bool]) -> bool:
    return all(has_form(shape) for shape in {id(shape): shape for shape in structure.shapes}.values())


def _shares_all_at_once(shape: Shape) -> bool:
    shared = frozenset(event for edges in shape.edges for event, _ in edges if event != INTERNAL) - shape.alone
    done: dict[int, frozenset[int]] = {shape.initial: frozenset()}
    waiting = [shape.initial]
    while waiting:
        state = waiting.pop()
        left = shared - done[state]
        if not left <= set(shape.offers[state]):
            return False
        for event, after in shape.edges[state]:
            if event in shared and event not in left:
                return False
            then = done[state] | ({event} & shared)
            if then == shared and after == shape.initial:
                then = frozenset()
            if after not in done:
                done[after] = then
                waiting.append(after)
            elif done[after] != then:
                return False
    return True


def resource_order(structure: Structure) -> list[int] | None:
    """The resources, which other components take and give back, each before those that are taken while it is held; None
    if not all components are resources or their users, or if there is a cycle.
    """
    found = [component for component, shape in enumerate(structure.shapes) if _is_resource(shape)]
    number = {component: at for at, component in enumerate(found)}
    for component, neighbours in enumerate(structure.neighbours):
        if any((neighbour.component in number) == (component in number) for neighbour in neighbours):
            return None
    before: list[set[int]] = [set() for _ in found]
    for user in range(len(structure.shapes)):
        if user not in number:
            for held, wanted in _taken_while_held(structure, user):
                before[number[wanted]].add(number[held])
    order = _sorted(before)
    return [found[at] for at in order] if order else None


def _taken_while_held(structure: Structure, user: int) -> Iterator[tuple[int, int]]:
    """Pairs of a resource that a user holds and another one that it takes meanwhile."""
    for state in structure.shapes[user].waiting:
        held, wanted = [], []
        for resource in structure.neighbours[user]:
            free = structure.shapes[resource.component].initial
            if free not in resource.reached.get(state, ()):
                held.append(resource.component)
            elif state in resource.requests:
                wanted.append(resource.component)
        yield from ((one, other) for one in held for other in wanted)


def _is_resource(shape: Shape) -> bool:
    free = shape.edges[shape.initial]
    taken = [after for _, after in free]
    return (
        bool(free)
        and len(shape.reachable) == len(free) + 1 == len(set(taken)) + 1
        and shape.initial not in taken
        and all([after for _, after in shape.edges[state]] == [shape.initial] for state in taken)
    )


def client_server_order(structure: Structure) -> list[int] | None:
    """The components, servers before their clients, if of each two neighbours one is the client of the other, without a
    cycle; None otherwise.

    A client that makes a request wants nothing else; a server that is open to one of its clients is open to all.
    """
    servers: list[set[int]] = [set() for _ in structure.shapes]
    for component, neighbours in enumerate(structure.neighbours):
        for neighbour in neighbours:
            if component < neighbour.component:
                client = _client(structure, component, neighbour.component)
                if client is None:
                    return None
                servers[client].add(component + neighbour.component - client)
    order = _sorted(servers)
    return order and [component for component in order if structure.neighbours[component]]


def _client(structure: Structure, one: int, two: int) -> int | None:
    """The client among two neighbours: the one that is committed to its requests."""
    shared = set(structure.events[one]) & set(structure.events[two])
    open_one, open_two = _is_open(structure, one, shared), _is_open(structure, two, shared)
    if open_one == open_two:
        return None
    return two if open_one else one


def _is_open(structure: Structure, component: int, shared: set[int]) -> bool:
    """Whether a component, in its initial state, waits and offers one of the shared events."""
    shape, events = structure.shapes[component], structure.events[component]
    offered = [events[number] for number in shape.offers[shape.initial] if number not in shape.alone]
    return shape.initial in shape.waiting and any(event in shared for event in offered)


def _sorted(before: list[set[int]]) -> list[int] | None:
    """A topological order in which each number comes after those ``before`` it; None if there is a cycle."""
    after: list[list[int]] = [[] for _ in before]
    for component, earlier in enumerate(before):
        for other in earlier:
            after[other].append(component)
    missing = [len(earlier) for earlier in before]
    order = [component for component, count in enumerate(missing) if not count]
    for component in order:
        for other in after[component]:
            missing[other] -= 1
            if not missing[other]:
                order.append(other)
    return order if len(order) == len(before) else None
