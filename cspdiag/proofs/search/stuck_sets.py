"""Which components are stuck in a global state: the deadlocked processes, and the largest set of components that never
move again.

A set of components is stuck if every event that one of them offers needs another one of them that does not offer it:
whatever the others do, none of the set moves. A failure (a missed sample, a fault) that is not possible now does not
count: components that only a failure could release are stuck. The union of two stuck sets is a stuck set, so there is a
largest one; it is a knot if one of its processes has not ended and offers an event. A knot stays, unless a failure ends
it.
"""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.proofs.transitions.systems.system import INTERNAL, System


class OffersByState:
    """What the components of a system offer, by state, computed once for examining many global states."""

    def __init__(self, system: System) -> None:
        self.system = system
        self.events = [
            [frozenset(event for event, _ in edges) for edges in component.edges] for component in system.components
        ]
        alone = frozenset(at for at, event in enumerate(system.events) if len(event.parties) < 2) | {INTERNAL}
        self._free = [[not alone.isdisjoint(events) for events in states] for states in self.events]
        self._shared = [set().union(*states) - alone for states in self.events]
        """The events of each component that have other parties, in whatever state it offers them."""

    def waiting(self, state: Sequence[int]) -> tuple[int, ...]:
        """The processes that have not ended."""
        return tuple(
            at
            for at, component in enumerate(self.system.components)
            if component.process and state[at] not in component.terminal
        )

    def knot(self, state: Sequence[int]) -> tuple[int, ...]:
        """The largest set of components that never move again; empty if no process in it wants to continue."""
        stuck = self._never_move(state)
        for at in stuck:
            component = self.system.components[at]
            if component.process and state[at] not in component.terminal and component.edges[state[at]]:
                return tuple(sorted(stuck))
        return ()

    def _never_move(self, state: Sequence[int]) -> set[int]:
        offered = [states[local] for states, local in zip(self.events, state, strict=True)]
        stuck = {at for at, (free, local) in enumerate(zip(self._free, state, strict=True)) if not free[local]}
        suspects = list(stuck)
        while suspects:
            at = suspects.pop()
            if at not in stuck or all(self._blocked(event, at, offered, stuck) for event in offered[at]):
                continue
            stuck.remove(at)
            # Only what it refuses was blocked because it is stuck.
            for event in self._shared[at] - offered[at]:
                suspects += [party for party in self.system.events[event].parties if party in stuck]
        return stuck

    def _blocked(self, event: int, at: int, offered: Sequence[frozenset[int]], stuck: set[int]) -> bool:
        fails = self.system.events[event].kind == "failure"
        return any(
            party != at and (fails or party in stuck) and event not in offered[party]
            for party in self.system.events[event].parties
        )
