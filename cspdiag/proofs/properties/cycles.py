"""Runs that continue forever with certain events only: a trace to a cycle of global states.

The loops of the components (``local_loops``) come first, which often exclude such a run; then, for very many components
that make no choice, their only run; then a short depth-first search; then, for large systems, the smallest system that
looks the same from outside; then all reachable states. States without a successor are removed from these repeatedly,
until only cycles and paths to them remain.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from operator import ne
from typing import TypeAlias

from cspdiag.proofs.properties.endless import Endless, Finite
from cspdiag.proofs.reduce.reduction import can_livelock, is_large, seen_from_outside
from cspdiag.proofs.rules.runs import first_unsteady, moves_of, only_run
from cspdiag.proofs.search.all_states import has_vectors
from cspdiag.proofs.search.closed_sets import ClosedSets, Ready
from cspdiag.proofs.search.local_loops import looping_part
from cspdiag.proofs.search.traces import causes
from cspdiag.proofs.structure.pairs import Structure
from cspdiag.proofs.transitions.systems.system import System
from cspdiag.proofs.verdict import LimitError, Limits, Move

MANY = 2000
"""With more components than this a search keeps few states, because each has an entry for every component."""

_MOST_MOVES = 1_000_000
"""An only run is not followed further."""

_BRIEF_SEARCH_STATES = 3000
"""The number of states of the short search, at least."""

_ROUNDS = 4
"""The short search has this many states for each component, too: a cycle around a ring has several."""

_ENTRIES = 30_000_000
"""All states of the short search together have no more local states than this, if they are more than
`_BRIEF_SEARCH_STATES`.
"""

State: TypeAlias = tuple[int, ...]
Successor: TypeAlias = tuple[Move, State]


def endless_run(system: System, events: Collection[int], limits: Limits) -> Endless | Finite:
    """A run that ends in a cycle of these events and internal steps, or that there is none. Raises LimitError."""
    part = looping_part(system, events)
    if part is None:
        return Finite("rules")
    found = _in_only_run(system, part, limits) if len(system.components) > MANY else None
    found = found or _brief_search(system, part, limits)
    if found is not None:
        return found
    if is_large(system) and _is_excluded_outside(system, set(events), limits):
        return Finite("minimization")
    if has_vectors():
        from cspdiag.proofs.properties.cycles_by_vectors import among_all_states
    else:
        from cspdiag.proofs.properties.cycles_one_by_one import among_all_states
    return among_all_states(system, part, limits)


def _in_only_run(system: System, part: System, limits: Limits) -> Endless | None:
    """The cycle of a network of components that make no choice, if it consists of steps of ``part``: all runs are the
    same up to the order of independent steps, so the search for it has no alternatives to remember.
    """
    structure = Structure(system, limits)
    if first_unsteady(structure) is not None:
        return None
    run = only_run(structure, limits, _MOST_MOVES)
    if run is None or run.period == 0:
        return None
    moves = moves_of(structure, run)
    start = first_repeated(system.initial, moves, run.period)
    cycle = () if start is None else moves[start : start + run.period]
    if start is None or not {move.event for move in cycle} <= _events_of(part):
        return None
    concerned = {party for move in cycle for party, _ in move.moves}
    return Endless("rules", causes(moves[:start], concerned), cycle)


def first_repeated(initial: Sequence[int], moves: Sequence[Move], period: int) -> int | None:
    """The number of moves to the first state that is reached again ``period`` moves later; None if there is none."""
    here, there = list(initial), list(initial)
    for move in moves[:period]:
        for party, after in move.moves:
            there[party] = after
    differing = sum(map(ne, here, there))
    start = 0
    while differing:
        if start + period == len(moves):
            return None
        for state, move in ((here, moves[start]), (there, moves[start + period])):
            for party, after in move.moves:
                differing -= here[party] != there[party]
                state[party] = after
                differing += here[party] != there[party]
        start += 1
    return start


def _events_of(part: System) -> set[int]:
    return {event for component in part.components for edges in component.edges for event, _ in edges}


def _brief_search(system: System, part: System, limits: Limits) -> Endless | None:
    """The shorter run of those that two walks find: one along stubborn sets, one in which the components that moved
    last move again.
    """
    sets = ClosedSets(system, limits)
    allowed = _events_of(part)

    def stubborn(state: State, ready: Ready, path: _Path) -> list[Successor]:
        return [way for event in sets.smallest(state, ready) for way in sets.moves(state, event)]

    def last_movers(state: State, ready: Ready, path: _Path) -> list[Successor]:
        ways = [way for event in sets.possible(state, ready) for way in sets.moves(state, event)]
        return sorted(ways, key=lambda way: max(path.last_move(party) for party, _ in way[0].moves))

    found = [_walk(system.initial, sets, ways, allowed, limits) for ways in (stubborn, last_movers)]
    return min(
        (endless for endless in found if endless is not None),
        key=lambda endless: len(endless.trace) + len(endless.cycle),
        default=None,
    )


class _Path:
    """The moves from the initial state."""

    def __init__(self) -> None:
        self.moves: list[Move] = []
        self._moved: dict[int, list[int]] = {}

    def add(self, move: Move) -> None:
        """Goes one move further."""
        for party, _ in move.moves:
            self._moved.setdefault(party, []).append(len(self.moves))
        self.moves.append(move)

    def drop(self) -> None:
        """Goes back one move, if there is one."""
        if self.moves:
            for party, _ in self.moves.pop().moves:
                self._moved[party].pop()

    def last_move(self, party: int) -> int:
        """The number of the last move of a component; -1 if it has not moved."""
        moved = self._moved.get(party)
        return moved[-1] if moved else -1


def _walk(
    initial: State,
    sets: ClosedSets,
    successors_of: Callable[[State, Ready, _Path], list[Successor]],
    allowed: set[int],
    limits: Limits,
) -> Endless | None:
    """Searches depth first for a while, the last successor first; a state that is on the path already closes
    a cycle.
    """
    path = _Path()
    on_path = {initial: 0}
    seen = {initial}
    ready = sets.ready(initial)
    pending = [(initial, ready, successors_of(initial, ready, path))]
    components = len(initial)
    most = max(_BRIEF_SEARCH_STATES, min(_ROUNDS * components, _ENTRIES // max(components, 1)))
    while pending and len(seen) < most:
        limits.check()
        state, ready, ways = pending[-1]
        if not ways:
            pending.pop()
            del on_path[state]
            path.drop()
            continue
        move, after = ways.pop()
        start = on_path.get(after)
        if start is not None and all(step.event in allowed for step in (*path.moves[start:], move)):
            cycle = (*path.moves[start:], move)
            concerned = {party for step in cycle for party, _ in step.moves}
            return Endless("stubborn", causes(path.moves[:start], concerned), cycle, len(seen))
        if after not in seen:
            seen.add(after)
            on_path[after] = len(pending)
            path.add(move)
            can = sets.ready_after(ready, move, after)
            pending.append((after, can, successors_of(after, can, path)))
    return None


def _is_excluded_outside(system: System, events: set[int], limits: Limits) -> bool:
    """Whether the smallest equivalent system, with these events hidden, has no internal loop."""
    kept = set(range(len(system.events))) - events
    try:
        reduced = seen_from_outside(system, kept, limits.part(limits.remaining / 2))
    except LimitError:
        return False
    return reduced is not None and not can_livelock(reduced)
