"""Random networks of the forms that designs have, and the truth about them by exploring every state."""

from __future__ import annotations

import random
from dataclasses import dataclass
from typing import Literal, TypeAlias

from cspdiag.proofs.transitions.systems.system import INTERNAL, Component, Event, System
from tests.proofs.systems import naive

Form: TypeAlias = Literal["cycles", "choices", "resources", "tokens", "anything"]
FORMS: tuple[Form, ...] = ("cycles", "choices", "resources", "tokens", "anything")


def random_network(seed: int, *, form: Form | None = None, components: int | None = None) -> System:
    """A small system; the same for the same arguments.

    ``cycles``: processes that repeat events in a fixed order or in parallel. ``choices``: they also choose.
    ``resources``: they take and give back what they share. ``tokens``: they pass something on along rings.
    ``anything``: random machines with internal steps, events of one and of three parties, failures, ends and stops.
    """
    chooser = random.Random(seed)
    chosen: Form = form or chooser.choice(FORMS)
    number = components or chooser.randint(2, 6)
    build = {"cycles": _cycles, "choices": _choices, "resources": _resources, "tokens": _tokens, "anything": _anything}
    return build[chosen](chooser, number)


Table: TypeAlias = list[list[tuple[str, int]]]


def _system(
    tables: list[Table],
    terminal: dict[int, frozenset[int]],
    channels: frozenset[int] = frozenset(),
    failures: frozenset[str] = frozenset(),
) -> System:
    parties: dict[str, list[int]] = {}
    for index, table in enumerate(tables):
        for name in {name for edges in table for name, _ in edges if name != "tau"}:
            parties.setdefault(name, []).append(index)
    numbers = {name: number for number, name in enumerate(sorted(parties))}
    components = tuple(
        Component(
            f"p{index}",
            tuple(
                tuple((INTERNAL if name == "tau" else numbers[name], after) for name, after in edges) for edges in table
            ),
            terminal.get(index, frozenset()),
            process=index not in channels,
        )
        for index, table in enumerate(tables)
    )
    events = tuple(
        Event(name, tuple(parties[name]), "failure" if name in failures else "communication")
        for name in sorted(parties)
    )
    return System(components, events)


def _edges_of_graph(chooser: random.Random, number: int) -> list[tuple[int, int]]:
    """A connected multigraph: the two parties of each channel."""
    joined = [(chooser.randrange(index), index) for index in range(1, number)]
    for _ in range(chooser.randint(0, number)):
        one, two = chooser.sample(range(number), 2)
        joined.append((one, two))
    return joined


def _sequence(events: list[list[str]]) -> Table:
    """A machine that repeats the groups in turn; the events of a group happen in any order."""
    table: Table = []
    starts = []
    for group in events:
        starts.append(len(table))
        table += [[] for _ in range(2 ** len(group) - 1)]
    for at, group in enumerate(events):
        full = 2 ** len(group) - 1
        following = starts[(at + 1) % len(starts)]
        for done in range(full):
            for position, event in enumerate(group):
                if not done >> position & 1:
                    after = done | 1 << position
                    table[starts[at] + done].append((event, following if after == full else starts[at] + after))
    return table


def _groups(chooser: random.Random, events: list[str]) -> list[list[str]]:
    chooser.shuffle(events)
    groups: list[list[str]] = []
    for event in events:
        if groups and len(groups[-1]) < 3 and chooser.random() < 0.4:
            groups[-1].append(event)
        else:
            groups.append([event])
    return groups


def _cycles(chooser: random.Random, number: int) -> System:
    events: list[list[str]] = [[] for _ in range(number)]
    for channel, parties in enumerate(_edges_of_graph(chooser, number)):
        for party in parties:
            events[party].append(f"c{channel}")
    for party, own in enumerate(events):
        if chooser.random() < 0.3:
            own.append(f"outside{party}")
    return _system([_sequence(_groups(chooser, own)) for own in events], {})


def _choices(chooser: random.Random, number: int) -> System:
    """Clients and servers: a client makes a request and waits for the answer, a server takes any request; some make
    internal choices.
    """
    tables: list[Table] = [[[]] for _ in range(number)]
    for channel, (one, two) in enumerate(_edges_of_graph(chooser, number)):
        if chooser.random() < 0.75:
            one, two = min(one, two), max(one, two)
        ask, answer = f"ask{channel}", f"answer{channel}"
        for party in (one, two):
            table = tables[party]
            inner = chooser.random() < 0.3 and len(table) > 1 and party == one
            # A request may be made while another one is served.
            at = chooser.randrange(len(table)) if inner else 0
            if inner and table[at]:
                event, after = table[at][0]
                table[at] = [(ask, len(table)), *table[at][1:]] if at == 0 else [(ask, len(table))]
                table.append([(answer, len(table) + 1)])
                table.append([(event, after)])
            else:
                own = party == one and chooser.random() < 0.7
                table[0].append(("tau" if own else ask, len(table)))
                if own:
                    table.append([(ask, len(table) + 1)])
                table.append([(answer, 0)])
    return _system(tables, {})


def _resources(chooser: random.Random, number: int) -> System:
    """Users who take resources, mostly in a common order, and give them back."""
    shared = max(2, number // 2)
    users = [chooser.sample(range(shared), chooser.randint(1, min(3, shared))) for _ in range(max(2, number - shared))]
    tables: list[Table] = []
    for user, needed in enumerate(users):
        if chooser.random() < 0.8:
            needed.sort()
        given = needed[:]
        chooser.shuffle(given)
        names = [f"take{user}.{resource}" for resource in needed] + [f"give{user}.{resource}" for resource in given]
        tables.append([[(name, (at + 1) % len(names))] for at, name in enumerate(names)])
    for resource in range(shared):
        takers = [user for user, needed in enumerate(users) if resource in needed]
        table: Table = [[(f"take{user}.{resource}", at + 1) for at, user in enumerate(takers)]]
        table += [[(f"give{user}.{resource}", 0)] for user in takers]
        tables.append(table)
    return _system(tables, {}, frozenset(range(len(users), len(tables))))


def _tokens(chooser: random.Random, number: int) -> System:
    """Rings of stations, some of which have a token; stations may do something in between, and may choose
    whether to.
    """
    tables: list[Table] = []
    for index in range(number):
        take, give, work = f"pass{index}", f"pass{(index + 1) % number}", f"work{index}"
        table: Table = [[(take, 1)], [(give, 0)]]
        choice = chooser.random()
        if choice < 0.3:
            table[1] = [(work, 2)]
            table.append([(give, 0)])
        elif choice < 0.6:
            table[1].append((work, 2))
            table.append([(give, 0)])
        if chooser.random() < 0.4:
            table = _turned(table)
        tables.append(table)
    helpers = []
    for index in range(number):
        if any(name == f"work{index}" for edges in tables[index] for name, _ in edges) and chooser.random() < 0.6:
            helpers.append([[(f"work{index}", 1)], [(f"done{index}" if chooser.random() < 0.5 else "tau", 0)]])
    return _system(tables + helpers, {})


def _turned(table: Table) -> Table:
    """The same machine with its first two states exchanged: it starts with the token."""
    exchanged = [table[1], table[0], *table[2:]]
    return [[(name, 1 - after if after < 2 else after) for name, after in edges] for edges in exchanged]


def _anything(chooser: random.Random, number: int) -> System:
    names = [f"e{event}" for event in range(chooser.randint(number, 2 * number))]
    alphabets: list[list[str]] = [[] for _ in range(number)]
    for name in names:
        count = chooser.choices((1, 2, 3), (0.15, 0.7, 0.15))[0]
        for party in chooser.sample(range(number), min(count, number)):
            alphabets[party].append(name)
    tables: list[Table] = []
    terminal: dict[int, frozenset[int]] = {}
    for index, alphabet in enumerate(alphabets):
        states = chooser.randint(1, 4)
        table: Table = [[] for _ in range(states)]
        # Every event of the alphabet occurs, so it has the parties that it should have.
        for name in alphabet:
            table[chooser.randrange(states)].append((name, chooser.randrange(states)))
        for edges in table:
            for _ in range(chooser.randint(0, 2)):
                if alphabet:
                    name = "tau" if chooser.random() < 0.1 else chooser.choice(alphabet)
                    edges.append((name, chooser.randrange(states)))
        terminal[index] = frozenset(state for state in range(states) if not table[state] and chooser.random() < 0.6)
        tables.append(table)
    channels = frozenset(index for index in range(number) if chooser.random() < 0.1)
    failures = frozenset(name for name in names if chooser.random() < 0.08)
    return _system(tables, terminal, channels, failures)


@dataclass(frozen=True)
class Truth:
    """The truth about all reachable states; None if there are more states than were explored."""

    states: int
    deadlock: bool
    knot: bool


def truth(system: System, most: int = 20_000) -> Truth | None:
    """Explore every reachable state, one after the other, in the plainest way."""
    found = {system.initial}
    waiting = [system.initial]
    deadlock = knot = False
    while waiting:
        state = waiting.pop()
        after = [following for _, following in naive.steps(system, state)]
        deadlock = deadlock or naive.deadlocked(system, state)
        knot = knot or bool(plain_knot(system, state))
        for following in after:
            if following not in found:
                found.add(following)
                waiting.append(following)
        if len(found) > most:
            return None
    return Truth(len(found), deadlock, knot)


def plain_knot(system: System, state: tuple[int, ...]) -> set[int]:
    """The greatest knot of a state, by removing processes that cannot be in it until nothing changes."""
    stuck = set(range(len(state)))
    while True:
        free = {
            index
            for index in stuck
            for event, _ in system.components[index].edges[state[index]]
            if event == INTERNAL
            or all(
                any(event == other for other, _ in system.components[party].edges[state[party]])
                # No process outside the knot will cause a failure.
                or (party not in stuck and system.events[event].kind != "failure")
                for party in system.events[event].parties
            )
        }
        if not free:
            break
        stuck -= free
    for index in stuck:
        component = system.components[index]
        if component.process and state[index] not in component.terminal and component.edges[state[index]]:
            return stuck
    return set()
