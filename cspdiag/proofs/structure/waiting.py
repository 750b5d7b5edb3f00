"""Orders of waiting: the rule behind acyclic client-server networks and ordered resources.

In a knot, every process that waits waits for a neighbour that waits too. A waiting state of a component is struck off
if one of the neighbours that it waits for has no waiting state left that is possible at the same time. A state that is
struck off can never be part of a knot; if no states are left, the order in which they were struck off is a proof: every
component waits only for earlier ones. This generalizes the rules of Roscoe and Dathi ("The pursuit of deadlock
freedom", 1987), Welch, Justo and Willcock ("High-level paradigms for deadlock-free high-performance systems", 1993) and
Martin and Jassim ("How to design deadlock-free networks using CSP and verification tools", 1997), which derive such an
order from the form of the processes.
"""

from __future__ import annotations

from collections import deque

from cspdiag.proofs.structure.pairs import Structure


class WaitingOrder:
    """The remaining waiting states: ``left[i]`` of component ``i``; ``order`` has the components in the order in which
    they lost their last one.
    """

    def __init__(self, structure: Structure, *, together: bool) -> None:
        self._structure = structure
        self._elimination = _Elimination(structure, together)
        self._elimination.begin()
        self._elimination.follow()
        self.left: list[set[int]] = self._elimination.left

    @property
    def order(self) -> tuple[int, ...]:
        """The components without remaining waiting states."""
        return tuple(self._elimination.order)

    def exclude(self, component: int) -> list[int]:
        """Strikes off the states in which a component requests something, because it has been proved in another way
        that it never waits forever, and all states that follow from that.

        Returns the components that lost their last state.
        """
        before = len(self._elimination.order)
        for state in self._structure.shapes[component].requesting:
            self._elimination.strike(component, state)
        self._elimination.follow()
        return self._elimination.order[before:]


def waiting_states(structure: Structure, *, together: bool) -> WaitingOrder:
    """The waiting states that may be part of a knot or, if all components wait ``together``, of a deadlock of the whole
    network. Raises LimitError.
    """
    return WaitingOrder(structure, together=together)


class _MultiwayEvent:
    """An event with three or more parties: ``refusing[i]`` counts the remaining states in which party ``i`` waits
    without offering it.
    """

    def __init__(self, refusing: dict[int, int]) -> None:
        self.refusing = refusing
        self.parties = sum(count > 0 for count in refusing.values())

    def lose(self, component: int) -> bool:
        """Removes a refusing state of party ``component``; returns whether the event has to be looked at again."""
        self.refusing[component] -= 1
        if self.refusing[component] == 0:
            self.parties -= 1
            return self.parties <= 1
        return False

    def parties_not_refused(self) -> list[int]:
        """The parties to which no other party can refuse the event any longer."""
        if self.parties > 1:
            return []
        if self.parties == 0:
            return list(self.refusing)
        return [component for component, count in self.refusing.items() if count]


class _Elimination:
    """The elimination in progress. ``counts`` has the number of states of a neighbour that still support a state of a
    component; entries are made when first needed.
    """

    def __init__(self, structure: Structure, together: bool) -> None:
        self.structure, self.together = structure, together
        self.left = [set(shape.waiting) for shape in structure.shapes]
        self.counts: dict[tuple[int, int, int], int] = {}
        self.struck: deque[tuple[int, int]] = deque()
        self.order: list[int] = []
        self.multiway_events: dict[int, _MultiwayEvent] = {}
        self.multiway_events_of: dict[int, list[tuple[int, int]]] = {}
        self._find_multiway_events()

    def _find_multiway_events(self) -> None:
        counts: dict[tuple[int, int], int] = {}
        for event, (roles, entry) in enumerate(zip(self.structure.roles, self.structure.system.events, strict=True)):
            if len(roles) < 3 or (entry.kind == "failure" and not self.together):
                continue
            refusing = {}
            for party, number in roles:
                shape = self.structure.shapes[party]
                key = (id(shape), number)
                if key not in counts:
                    counts[key] = sum(number not in shape.offers[state] for state in shape.waiting)
                refusing[party] = counts[key]
                self.multiway_events_of.setdefault(party, []).append((event, number))
            self.multiway_events[event] = _MultiwayEvent(refusing)

    def strike(self, component: int, state: int) -> None:
        if state in self.left[component]:
            self.left[component].discard(state)
            self.struck.append((component, state))
            if not self.left[component]:
                self.order.append(component)

    def strike_offers(self, event: int, components: list[int]) -> None:
        """Strikes off the states in which these components offer an event that no other party can refuse: they do not
        wait there.
        """
        for component in components:
            number = self.structure.events[component].index(event)
            offers = self.structure.shapes[component].offers
            for state in [state for state in self.left[component] if number in offers[state]]:
                self.strike(component, state)

    def begin(self) -> None:
        self.order += [component for component, states in enumerate(self.left) if not states]
        for component, neighbours in enumerate(self.structure.neighbours):
            for neighbour in neighbours:
                for state in neighbour.never_blocked:
                    if self.together or state in neighbour.requests:
                        self.strike(component, state)
                for state, others in neighbour.without_failure.items():
                    if not others:
                        self.strike(component, state)
        for event, multiway_event in self.multiway_events.items():
            self.strike_offers(event, multiway_event.parties_not_refused())

    def follow(self) -> None:
        while self.struck:
            self.structure.limits.check()
            component, state = self.struck.popleft()
            self._withdraw_support(component, state)
            for event, number in self.multiway_events_of.get(component, ()):
                refused = number not in self.structure.shapes[component].offers[state]
                if refused and self.multiway_events[event].lose(component):
                    self.strike_offers(event, self.multiway_events[event].parties_not_refused())

    def _withdraw_support(self, component: int, state: int) -> None:
        for neighbour in self.structure.neighbours[component]:
            for other in neighbour.blocked.get(state, ()):
                if not self.together and other not in neighbour.requested:
                    continue
                key = (neighbour.component, other, component)
                count = self.counts.get(key)
                if count is None:
                    count = len(neighbour.blocked_back[other])
                self.counts[key] = count - 1
                if count == 1:
                    self.strike(neighbour.component, other)
