"""Cycles among all reachable states, by vectors of numpy: states without a successor are removed repeatedly, until only
cycles and paths to them remain.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from cspdiag.proofs.properties.endless import Endless, Finite, shortest_cycle
from cspdiag.proofs.search.breadth_first import CHUNK, Exploration, explore, trace_to
from cspdiag.proofs.search.closed_sets import ClosedSets
from cspdiag.proofs.search.packing import Flags, Packing, Words
from cspdiag.proofs.transitions.systems.system import System
from cspdiag.proofs.verdict import Limits, Move

Edges = npt.NDArray[np.int64]


def among_all_states(system: System, part: System, limits: Limits) -> Endless | Finite:
    """A run that ends in a cycle of the steps of ``part``, or that there is none. Raises LimitError."""
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
        limits.check()
        state = search.state(number)
        ways = [way for event in sets.possible(state) for way in sets.moves(state, event)]
        numbers = search.table.find(search.packing.pack([after for _, after in ways])).tolist()
        return [(move, after) for (move, _), after in zip(ways, numbers, strict=True) if after in endless]

    walked: dict[int, int] = {}
    number = int(left[0])
    while number not in walked:
        walked[number] = len(walked)
        number = onward(number)[0][1]
    start = min(member for member, place in walked.items() if place >= walked[number])
    return Endless("breadth-first", trace_to(search, start), shortest_cycle(start, onward), search.states)
