"""The plainest interpretation of a system: global states as tuples, one at a time. Engines are compared with it."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from itertools import combinations, product
from typing import TypeAlias

from cspdiag.proofs.transitions.systems.system import INTERNAL, System
from cspdiag.proofs.verdict import Move

State: TypeAlias = tuple[int, ...]


def steps(system: System, state: State) -> Iterator[tuple[Move, State]]:
    """Every move from a state, and the state after it."""
    for at, component in enumerate(system.components):
        for event, target in component.edges[state[at]]:
            if event == INTERNAL:
                yield _moved(state, INTERNAL, [(at, target)])
    for number, event in enumerate(system.events):
        choices = [
            [target for offered, target in system.components[party].edges[state[party]] if offered == number]
            for party in event.parties
        ]
        for targets in product(*choices):
            yield _moved(state, number, list(zip(event.parties, targets, strict=True)))


def _moved(state: State, event: int, moves: Sequence[tuple[int, int]]) -> tuple[Move, State]:
    after = list(state)
    for party, target in moves:
        after[party] = target
    return Move(event, tuple(moves)), tuple(after)


def layers(system: System) -> list[list[State]]:
    """All reachable states, by their distance from the initial one."""
    found = [[system.initial]]
    seen = {system.initial}
    while found[-1]:
        found.append([])
        for state in found[-2]:
            for _, after in steps(system, state):
                if after not in seen:
                    seen.add(after)
                    found[-1].append(after)
    return found[:-1]


def deadlocked(system: System, state: State) -> bool:
    """Nothing is possible, and some process has not ended."""
    ended = all(state[at] in component.terminal for at, component in enumerate(system.components) if component.process)
    return not ended and not any(True for _ in steps(system, state))


def knotted(system: System, state: State) -> bool:
    """Some set of components never moves again, if nothing fails later, and a process in the set is waiting: every set
    is tried.
    """
    offers = [
        frozenset(event for event, _ in component.edges[local])
        for component, local in zip(system.components, state, strict=True)
    ]
    wanting = [
        component.process and local not in component.terminal and bool(offered)
        for component, local, offered in zip(system.components, state, offers, strict=True)
    ]
    everyone = range(len(state))
    return any(
        any(wanting[at] for at in members) and all(_never_moves(system, offers, at, members) for at in members)
        for size in range(1, len(state) + 1)
        for members in combinations(everyone, size)
    )


def _never_moves(system: System, offers: Sequence[frozenset[int]], at: int, members: Sequence[int]) -> bool:
    return all(
        event != INTERNAL
        and any(
            party != at and (party in members or system.events[event].kind == "failure") and event not in offers[party]
            for party in system.events[event].parties
        )
        for event in offers[at]
    )


def replay(system: System, trace: Sequence[Move]) -> State:
    """Take every step of a trace from the initial state: each must be possible. Returns the last state."""
    state = system.initial
    for move in trace:
        after = [after for possible, after in steps(system, state) if set(possible.moves) == set(move.moves)
                 and possible.event == move.event]  # fmt: skip
        assert after, f"{move} is not possible in {state}"
        state = after[0]
    return state


def repeats(system: System, state: State, events: Collection[int]) -> bool:
    """Whether the state can be reached again by these events and internal steps alone."""
    pending = [state]
    seen: set[State] = set()
    while pending:
        for move, after in steps(system, pending.pop()):
            if move.event != INTERNAL and move.event not in events:
                continue
            if after == state:
                return True
            if after not in seen:
                seen.add(after)
                pending.append(after)
    return False


def livelocked(system: System, state: State) -> bool:
    """The state can be reached again without visible events, environment or time."""
    hidden = {
        number
        for number, event in enumerate(system.events)
        if not event.visible and event.kind not in ("external", "sample", "miss", "time")
    }
    return repeats(system, state, hidden)


def never_ends(system: System, state: State) -> bool:
    """The state is a deadlock, or can be reached again."""
    return deadlocked(system, state) or repeats(system, state, range(len(system.events)))
