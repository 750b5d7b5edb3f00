"""Runs that continue forever with certain events only: a trace to a cycle of global states.

The loops of the components (``local_loops``) come first, which often exclude such a run; then a short depth-first
search; then, for large systems, the smallest system that looks the same from outside; then all reachable states. States
without a successor are removed from these repeatedly, until only cycles and paths to them remain.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from cspdiag.base.record import record
from cspdiag.proofs.reduce.reduction import can_livelock, is_large, seen_from_outside
from cspdiag.proofs.search.breadth_first import CHUNK, Exploration, explore, trace_to
from cspdiag.proofs.search.closed_sets import ClosedSets, Ready
from cspdiag.proofs.search.local_loops import looping_part
from cspdiag.proofs.search.packing import Flags, Packing, Words
from cspdiag.proofs.search.traces import causes
from cspdiag.proofs.transitions.systems.system import System
from cspdiag.proofs.verdict import LimitError, Limits, Method, Move

_BRIEF_SEARCH_STATES = 3000
"""The number of states of the short search, at least."""

_ROUNDS = 4
"""The short search has this many states for each component, too: a cycle around a ring has several."""

_ENTRIES = 30_000_000
"""All states of the short search together have no more local states than this, if they are more than
`_BRIEF_SEARCH_STATES`.
"""

Edges = npt.NDArray[np.int64]
State: TypeAlias = tuple[int, ...]
Successor: TypeAlias = tuple[Move, State]


@record
class Endless:
    """A run that never ends: ``trace`` from the initial state, then ``cycle`` forever."""

    method: Method
    trace: tuple[Move, ...]
    cycle: tuple[Move, ...]
    states: int | None = None


@record
class Finite:
    """No run has infinitely many of the events in a row; ``states`` is the number of states explored, None if none had
    to be.
    """

    method: Method
    states: int | None = None


def endless_run(system: System, events: Collection[int], limits: Limits) -> Endless | Finite:
    """A run that ends in a cycle of these events and internal steps, or that there is none. Raises LimitError."""
    part = looping_part(system, events)
    if part is None:
        return Finite("rules")
    found = _brief_search(system, part, limits)
    if found is not None:
        return found
    if is_large(system) and _is_excluded_outside(system, set(events), limits):
        return Finite("minimization")
    return _among_all_states(system, part, limits)


def _brief_search(system: System, part: System, limits: Limits) -> Endless | None:
    """The shorter run of those that two walks find: one along stubborn sets, one in which the components that moved
    last move again.
    """
    sets = ClosedSets(system, limits)
    allowed = {event for component in part.components for edges in component.edges for event, _ in edges}

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
        reduced = seen_from_outside(system, kept, Limits(limits.remaining / 2, limits.memory))
    except LimitError:
        return False
    return reduced is not None and not can_livelock(reduced)


def _among_all_states(system: System, part: System, limits: Limits) -> Endless | Finite:
    packing = Packing(system)
    search = explore(packing, limits, _nothing)
    sources, targets = _edges(search, Packing(part), limits)
    left = _without_ends(search.states, sources, targets, limits)
    if not len(left):
        return Finite("breadth-first", search.states)
    return _shortest_cycle(search, part, left, limits)


def _nothing(words: Words, can_step: Flags) -> None:
    """The condition of a search that is to reach all states."""


def _edges(search: Exploration, packing: Packing, limits: Limits) -> tuple[Edges, Edges]:
    """The numbers of the states before and after each step of ``packing`` between states that were found."""
    sources, targets = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)]
    size = 0
    for first in range(0, search.states, CHUNK):
        here = search.table.states(first, min(first + CHUNK, search.states))
        for step in packing.steps:
            limits.check()
            at = np.flatnonzero(step.enabled(here))
            if len(at):
                sources.append(at + first)
                targets.append(search.table.find(step.after(here, at)))
                size += 2 * at.nbytes
        limits.check(search.table.bytes + 3 * size)
    return np.concatenate(sources), np.concatenate(targets)


def _without_ends(states: int, sources: Edges, targets: Edges, limits: Limits) -> Edges:
    """The states from which an infinite path leads. Raises LimitError."""
    order = np.argsort(targets, kind="stable")
    before = sources[order]
    first = np.searchsorted(targets[order], np.arange(states + 1))
    leaving = np.bincount(sources, minlength=states)
    ends = np.flatnonzero(leaving == 0)
    while len(ends):
        limits.check()
        leaving[ends] = -1
        counts = first[ends + 1] - first[ends]
        starts = np.repeat(first[ends] - np.concatenate(([0], np.cumsum(counts)[:-1])), counts)
        reached = before[starts + np.arange(len(starts))]
        np.subtract.at(leaving, reached, 1)
        ends = np.unique(reached[leaving[reached] == 0])
    return np.flatnonzero(leaving > 0)


def _shortest_cycle(search: Exploration, part: System, left: Edges, limits: Limits) -> Endless:
    """The cycle that a walk through the remaining states reaches, and a shortest trace to it."""
    endless = set(left.tolist())
    sets = ClosedSets(part, limits)

    def onward(number: int) -> list[tuple[Move, int]]:
        state = search.state(number)
        ways = [way for event in sets.possible(state) for way in sets.moves(state, event)]
        numbers = search.table.find(search.packing.pack([after for _, after in ways])).tolist()
        return [(move, after) for (move, _), after in zip(ways, numbers, strict=True) if after in endless]

    walked: dict[int, int] = {}
    number = int(left[0])
    while number not in walked:
        limits.check()
        walked[number] = len(walked)
        number = onward(number)[0][1]
    start = min(member for member, place in walked.items() if place >= walked[number])
    came: dict[int, tuple[int, Move]] = {}
    pending = [start]
    for member in pending:
        for move, after in onward(member):
            limits.check()
            if after not in came:
                came[after] = (member, move)
                pending.append(after)
        if start in came:
            break
    cycle: list[Move] = []
    at = start
    while not cycle or at != start:
        at, move = came[at]
        cycle.append(move)
    return Endless("breadth-first", trace_to(search, start), tuple(reversed(cycle)), search.states)
