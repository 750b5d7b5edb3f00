"""The conditions of searches, decided for many packed states at once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cspdiag.proofs.search.packing import Field, Flags, Indices, Packing, Words
from cspdiag.proofs.search.stuck_sets import OffersByState
from cspdiag.proofs.transitions.systems.system import INTERNAL
from cspdiag.proofs.verdict import Limits


class Deadlocks:
    """States in which nothing is possible although a process has not ended."""

    def __init__(self, packing: Packing) -> None:
        self._offers = OffersByState(packing.system)
        self._unended = [
            (field, _table(field, [state not in component.terminal for state in range(len(component.edges))]))
            for field, component in zip(packing.fields, packing.system.components, strict=True)
            if component.process
        ]

    def __call__(self, words: Words, can_step: Flags) -> Flags | None:
        """Which states are deadlocks; None if none is."""
        still = np.flatnonzero(~can_step)
        if not len(still):
            return None
        few = [word[still] for word in words]
        unended = np.zeros(len(still), np.bool_)
        for field, table in self._unended:
            unended |= table.take(field.of(few))
        hits = np.zeros(len(can_step), np.bool_)
        hits[still[unended]] = True
        return hits if unended.any() else None

    def stuck(self, state: tuple[int, ...]) -> tuple[int, ...]:
        """The processes that have not ended in a deadlock."""
        return self._offers.waiting(state)


class Knots:
    """States in which some processes wait for each other forever (see ``stuck_sets``). All methods may raise
    LimitError.
    """

    def __init__(self, packing: Packing, limits: Limits) -> None:
        system = packing.system
        self._limits = limits
        self._offers = OffersByState(system)
        self._fields = packing.fields
        alone = {at for at, event in enumerate(system.events) if len(event.parties) < 2} | {INTERNAL}
        self._may_be_stuck = []
        self._wants = []
        self._shared: list[list[tuple[Flags, list[tuple[int, Flags]], bool]]] = []
        refusals = [
            [(party, ~self._offering(number, party)) for party in event.parties] if len(event.parties) > 1 else []
            for number, event in enumerate(system.events)
        ]
        for at, (field, component) in enumerate(zip(packing.fields, system.components, strict=True)):
            limits.check()
            events = self._offers.events[at]
            self._may_be_stuck.append(_table(field, [alone.isdisjoint(offered) for offered in events]))
            wants = [
                component.process and state not in component.terminal and bool(offered)
                for state, offered in enumerate(events)
            ]
            self._wants.append(_table(field, wants))
            self._shared.append(
                [
                    (self._offering(event, at), refusals[event], system.events[event].kind == "failure")
                    for event in sorted(set().union(*events) - alone)
                ]
            )

    def __call__(self, words: Words, can_step: Flags) -> Flags | None:
        """Which states contain a knot; None if none does."""
        left = np.arange(len(can_step))
        states = [field.of(words) for field in self._fields]
        stuck = [table.take(local) for table, local in zip(self._may_be_stuck, states, strict=True)]
        while True:
            kept = np.flatnonzero(self._holds(states, stuck))
            if not len(kept):
                return None
            left = left[kept]
            states = [local[kept] for local in states]
            stuck = [flags[kept] for flags in stuck]
            if not self._release(states, stuck):
                hits = np.zeros(len(can_step), np.bool_)
                hits[left] = True
                return hits

    def stuck(self, state: tuple[int, ...]) -> tuple[int, ...]:
        """The components that never move again."""
        return self._offers.knot(state)

    def _offering(self, event: int, at: int) -> Flags:
        return _table(self._fields[at], [event in offered for offered in self._offers.events[at]])

    def _holds(self, states: list[Indices], stuck: list[Flags]) -> Flags:
        """Which states still have a process that may be stuck and wants to continue."""
        holds = np.zeros(len(stuck[0]), np.bool_)
        for local, flags, table in zip(states, stuck, self._wants, strict=True):
            holds |= flags & table.take(local)
        return holds

    def _release(self, states: list[Indices], stuck: list[Flags]) -> bool:
        """Removes from the components that may be stuck those with an event that no stuck partner refuses. Returns
        whether there was one.
        """
        changed = False
        for at, events in enumerate(self._shared):
            if not stuck[at].any():
                continue
            before = np.count_nonzero(stuck[at])
            self._limits.check()
            for offering, refusals, fails in events:
                blocked = ~offering.take(states[at])
                for party, refuses in refusals:
                    if party == at:
                        continue
                    refused = refuses.take(states[party])
                    blocked |= refused if fails else stuck[party] & refused
                stuck[at] &= blocked
            changed |= bool(np.count_nonzero(stuck[at]) != before)
        return changed


def _table(field: Field, flags: Sequence[bool]) -> Flags:
    """A flag for each value of a field; unset for values that are no state."""
    table = np.zeros(field.mask + 1, np.bool_)
    table[: len(flags)] = flags
    return table
