"""Every reachable state, layer by layer: exact numbers of states, and shortest traces.

All states of a layer take each step together, as vectors (see ``packing``); a trace is found backwards from its end, a
layer at a time.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np

from cspdiag.proofs.search.backwards import Backwards
from cspdiag.proofs.search.packed_conditions import Deadlocks, Knots
from cspdiag.proofs.search.packing import Flags, Packing, Words
from cspdiag.proofs.search.state_table import StateTable
from cspdiag.proofs.transitions.systems.system import System
from cspdiag.proofs.verdict import LimitError, Limits, Move, Proved, Refuted, Unknown, Verdict, no_reachable_state_is

CHUNK = 1 << 15
"""The number of states that take a step together, so the vectors of one step fit into a processor's cache."""

Condition: TypeAlias = Callable[[Words, Flags], Flags | None]
"""The condition of a search: given states, and whether each has a step, which of them are sought; None if none is."""


@dataclass
class Exploration:
    """The result of a search. ``found`` is the number of the state that ended it, None if all states were reached."""

    packing: Packing
    table: StateTable
    layers: list[int] = field(default_factory=lambda: [0])
    """Where each layer begins among the numbers of the states."""
    deadlocks: int = 0
    found: int | None = None

    @property
    def states(self) -> int:
        """The number of states reached."""
        return self.table.count

    def state(self, number: int) -> tuple[int, ...]:
        """The states of the components in the state with this number."""
        return self.packing.unpack(self.table.states(number, number + 1), 0)


def deadlock_free(system: System, limits: Limits) -> Verdict:
    """Whether no state is reachable in which nothing is possible and a process has not ended."""
    return _search(system, limits, Deadlocks, "deadlocked")


def knot_free(system: System, limits: Limits) -> Verdict:
    """Whether no state is reachable in which some processes wait for each other forever, whatever the others do."""
    return _search(system, limits, lambda packing: Knots(packing, limits), "a knot")


def _search(system: System, limits: Limits, condition: Callable[[Packing], Deadlocks | Knots], name: str) -> Verdict:
    packing = Packing(system)
    try:
        looked_for = condition(packing)
        search = explore(packing, limits, looked_for)
        if search.found is None:
            return Proved("breadth-first", f"{no_reachable_state_is(search.states)} {name}", search.states)
        stuck = looked_for.stuck(search.state(search.found))
        return Refuted("breadth-first", trace_to(search, search.found), stuck, states=search.states)
    except LimitError as stop:
        return Unknown("breadth-first", str(stop))


def explore(packing: Packing, limits: Limits, seen: Condition) -> Exploration:
    """Reaches all states, or those up to the first that satisfies the condition ``seen``. Raises LimitError."""
    search = Exploration(packing, StateTable(packing.words, limits))
    search.table.add(packing.pack([packing.system.initial]))
    first, last = 0, 1
    while first < last:
        for start in range(first, last, CHUNK):
            limits.check(search.table.bytes)
            here = [word.copy() for word in search.table.states(start, min(start + CHUNK, last))]
            can_step = _take_steps(packing, search.table, here, limits)
            hits = seen(here, can_step)
            if hits is not None:
                search.found = start + int(np.flatnonzero(hits)[0])
                return search
        search.layers.append(last)
        first, last = last, search.table.count
    return search


def count(system: System, limits: Limits) -> tuple[int, int]:
    """The number of reachable states, and of deadlocks among them. Raises LimitError."""
    packing = Packing(system)
    condition = Deadlocks(packing)
    deadlocks = 0

    def counting(words: Words, can_step: Flags) -> None:
        nonlocal deadlocks
        hits = condition(words, can_step)
        deadlocks += 0 if hits is None else int(np.count_nonzero(hits))

    search = explore(packing, limits, counting)
    return search.states, deadlocks


def _take_steps(packing: Packing, table: StateTable, here: Words, limits: Limits) -> Flags:
    """Adds the states after every step from ``here`` to the table. Returns which of those have a step."""
    can_step = np.zeros(len(here[0]), np.bool_)
    after: list[Words] = []
    pending = 0
    for step in packing.steps:
        limits.check()
        enabled = step.enabled(here)
        at = np.flatnonzero(enabled)
        if len(at):
            can_step |= enabled
            after.append(step.after(here, at))
            pending += len(at) * packing.words * 8
            limits.check(table.bytes + pending)
    if after:
        table.add([np.concatenate(parts) for parts in zip(*after, strict=True)])
    return can_step


def trace_to(search: Exploration, number: int) -> tuple[Move, ...]:
    """A shortest trace from the initial state to the state with this number."""
    backwards = Backwards(search.packing.system)
    layer = int(np.searchsorted(search.layers, number, side="right")) - 1
    state = search.state(number)
    moves: list[Move] = []
    while layer > 0:
        layer -= 1
        options = list(backwards.before(state))
        numbers = search.table.find(search.packing.pack([before for _, before in options]))
        first, last = search.layers[layer], search.layers[layer + 1]
        chosen = int(np.flatnonzero((numbers >= first) & (numbers < last))[0])
        move, state = options[chosen]
        moves.append(move)
    return tuple(reversed(moves))
