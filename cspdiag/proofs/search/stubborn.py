"""Search with stubborn sets: in every state only the events of one set are explored, with which all others cannot
interfere.

Events outside the set neither enable nor prevent those in it, and commute with them, so it is enough to explore the set
(Valmari, "The state explosion problem", 1998). This preserves all deadlocks. A knot stays once it exists; to preserve
knots too, no possible event may be ignored forever: the final strongly connected components of the reduced graph are
checked for ignored events, and widened.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import TypeAlias

from cspdiag.base.graphs import final_components
from cspdiag.proofs.search.closed_sets import ClosedSets, Ready
from cspdiag.proofs.search.stuck_sets import OffersByState
from cspdiag.proofs.search.traces import causes, moves_to
from cspdiag.proofs.transitions.systems.system import System
from cspdiag.proofs.verdict import LimitError, Limits, Move, Proved, Refuted, Unknown, Verdict

State: TypeAlias = tuple[int, ...]

_BYTES_PER_STATE = 500
"""The size of a parent with its move, a dictionary entry, and edges; the tuple of the components' states is not
included.
"""


@dataclass
class _Graph:
    """The explored part of the state space; states are numbered in the order in which they were found."""

    states: list[State]
    numbers: dict[State, int]
    parents: list[tuple[int, Move] | None]
    after: list[list[int]] = field(default_factory=list)
    taken: list[set[int]] = field(default_factory=list)
    ready: dict[int, Ready] = field(default_factory=dict)
    """Of states that are not expanded yet, the components that can move."""

    def reach(self, state: State, parent: int, move: Move) -> tuple[int, bool]:
        """The number of a state, which is added if it is new, and whether it is."""
        number = self.numbers.setdefault(state, len(self.states))
        is_new = number == len(self.states)
        if is_new:
            self.states.append(state)
            self.parents.append((parent, move))
        return number, is_new

    def trace(self, number: int) -> tuple[Move, ...]:
        """The moves that lead to a state."""
        return moves_to(number, self.parents)


def deadlock_free(system: System, limits: Limits) -> Verdict:
    """Whether no state is reachable in which nothing is possible and a process has not ended."""
    graph = _Graph([system.initial], {system.initial: 0}, [None])
    try:
        sets, offers = ClosedSets(system, limits), OffersByState(system)
        for number in _follow(graph, sets, limits):
            if graph.after[number]:
                continue
            waiting = offers.waiting(graph.states[number])
            if waiting:
                return Refuted("stubborn", graph.trace(number), waiting, states=len(graph.states))
    except LimitError as stop:
        return Unknown("stubborn", str(stop))
    count = len(graph.states)
    reason = f"none of the {count} representative states is deadlocked"
    return Proved("stubborn", "the only representative state is not deadlocked" if count == 1 else reason, count)


def knot_free(system: System, limits: Limits) -> Verdict:
    """Whether no state is reachable in which some processes wait for each other forever, whatever the others do.

    Unknown if there are failures: a failure may end a knot, which the reduction then does not preserve.
    """
    if any(event.kind == "failure" for event in system.events):
        return Unknown(
            "stubborn",
            "a missed sample or a fault may end the wait of those who seem stuck, and then the order of steps matters",
        )
    graph = _Graph([system.initial], {system.initial: 0}, [None])
    try:
        sets, offers = ClosedSets(system, limits), OffersByState(system)
        while True:
            for _ in _follow(graph, sets, limits):
                pass
            widened = False
            for final in final_components(graph.after):
                first = min(final)
                if offers.knot(graph.states[first]):
                    return _knot(graph, offers, first)
                limits.check()
                widened |= _widen(graph, sets, final)
            if not widened:
                break
    except LimitError as stop:
        return Unknown("stubborn", str(stop))
    count = len(graph.states)
    reason = f"in none of the {count} representative states is a process stuck"
    return Proved("stubborn", "in the only representative state no process is stuck" if count == 1 else reason, count)


def _follow(graph: _Graph, sets: ClosedSets, limits: Limits) -> Iterator[int]:
    """Takes the steps of a stubborn set from every state that is not expanded yet; yields the numbers of
    these states.
    """
    while len(graph.after) < len(graph.states):
        number = len(graph.after)
        limits.check(len(graph.states) * (_BYTES_PER_STATE + 8 * len(graph.states[0])))
        graph.after.append([])
        graph.taken.append(set())
        state = graph.states[number]
        ready = graph.ready.pop(number) if number in graph.ready else sets.ready(state)
        _take(graph, sets, number, ready, sets.smallest(state, ready))
        yield number


def _take(graph: _Graph, sets: ClosedSets, number: int, ready: Ready, events: Iterable[int]) -> None:
    state = graph.states[number]
    for event in events:
        if event in graph.taken[number]:
            continue
        graph.taken[number].add(event)
        for move, after in sets.moves(state, event):
            reached, is_new = graph.reach(after, number, move)
            graph.after[number].append(reached)
            if is_new:
                graph.ready[reached] = sets.ready_after(ready, move, after)


def _widen(graph: _Graph, sets: ClosedSets, final: list[int]) -> bool:
    """Takes the events that a final component ignores forever, with the smallest stubborn set that contains one of
    them, from its first state; returns whether there are any.
    """
    first = min(final)
    taken = set().union(*(graph.taken[number] for number in final))
    ready = sets.ready(graph.states[first])
    ignored = [event for event in sets.possible(graph.states[first], ready) if event not in taken]
    if not ignored:
        return False
    closures = [sets.closure(graph.states[first], event) for event in ignored]
    fewest: list[int] = min(closures, key=len)
    _take(graph, sets, first, ready, fewest)
    return True


def _knot(graph: _Graph, offers: OffersByState, number: int) -> Refuted:
    """The knot of a state, at the first state on the path that contains it, with the moves that cause it."""
    stuck = offers.knot(graph.states[number])
    while (parent := graph.parents[number]) is not None and offers.knot(graph.states[parent[0]]):
        number = parent[0]
        stuck = offers.knot(graph.states[number])
    return Refuted("stubborn", causes(graph.trace(number), stuck), stuck, states=len(graph.states))
