"""Every reachable state, one after the other, without numpy: the answers of ``breadth_first``, some fifty times slower.

Of several shortest traces it may find another one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeAlias

from cspdiag.proofs.search.closed_sets import ClosedSets
from cspdiag.proofs.search.stuck_sets import OffersByState
from cspdiag.proofs.search.traces import moves_to
from cspdiag.proofs.transitions.systems.system import System
from cspdiag.proofs.verdict import LimitError, Limits, Move, Proved, Refuted, Unknown, Verdict, no_reachable_state_is

State: TypeAlias = tuple[int, ...]
Condition: TypeAlias = Callable[[State, bool], tuple[int, ...]]
"""What is stuck in a state, given whether anything is possible in it; nothing ends the search."""

_BYTES_PER_STATE = 400
"""The size of a parent with its move and of a dictionary entry, without the tuple of the components' states."""


@dataclass
class Reached:
    """The states in the order in which they were found, each with the move that led to it; ``stuck`` is what the
    condition found in the last one, if it ended the search.
    """

    states: list[State]
    numbers: dict[State, int]
    parents: list[tuple[int, Move] | None]
    stuck: tuple[int, ...] = ()
    found: int | None = None
    after: list[list[int]] = field(default_factory=list)
    """The states after each state; those of the last one may be missing."""

    def trace_to(self, number: int) -> tuple[Move, ...]:
        """A shortest trace from the initial state."""
        return moves_to(number, self.parents)


def deadlock_free(system: System, limits: Limits) -> Verdict:
    """Whether no state is reachable in which nothing is possible and a process has not ended."""
    offers = OffersByState(system)
    return _search(system, limits, lambda state, can_step: () if can_step else offers.waiting(state), "deadlocked")


def knot_free(system: System, limits: Limits) -> Verdict:
    """Whether no state is reachable in which some processes wait for each other forever, whatever the others do."""
    offers = OffersByState(system)
    return _search(system, limits, lambda state, can_step: offers.knot(state), "a knot")


def _search(system: System, limits: Limits, condition: Condition, name: str) -> Verdict:
    try:
        search = explore(system, limits, condition)
    except LimitError as stop:
        return Unknown("breadth-first", str(stop))
    count = len(search.states)
    if search.found is None:
        return Proved("breadth-first", f"{no_reachable_state_is(count)} {name}", count)
    return Refuted("breadth-first", search.trace_to(search.found), search.stuck, states=count)


def explore(system: System, limits: Limits, condition: Condition) -> Reached:
    """Reaches all states, or those up to the first in which the condition finds something. Raises LimitError."""
    sets = ClosedSets(system, limits)
    search = Reached([system.initial], {system.initial: 0}, [None])
    ready = {0: sets.ready(system.initial)}
    for number, state in enumerate(search.states):  # It grows.
        limits.check(len(search.states) * (_BYTES_PER_STATE + 8 * len(state)))
        can = ready.pop(number)
        search.stuck = condition(state, bool(can))
        if search.stuck:
            search.found = number
            return search
        following = []
        for event in sets.possible(state, can):
            for move, after in sets.moves(state, event):
                reached = search.numbers.setdefault(after, len(search.states))
                if reached == len(search.states):
                    search.states.append(after)
                    search.parents.append((number, move))
                    ready[reached] = sets.ready_after(can, move, after)
                following.append(reached)
        search.after.append(following)
    return search
