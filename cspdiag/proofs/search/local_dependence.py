"""Dependence between events within one component: which of its events exclude or change each other, and which enable
others.

Events are numbered as in the system; a component's internal step counts as one more event of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import TypeAlias

from cspdiag.base.graphs import reached
from cspdiag.proofs.verdict import Limits

Targets: TypeAlias = dict[int, tuple[int, ...]]
"""For each event that a state offers, the states after it."""


class LocalDependence:
    """Dependence between events within one component, computed when it is needed. All methods may raise LimitError."""

    def __init__(self, states: Sequence[Targets], limits: Limits) -> None:
        self._states = states
        self._limits = limits
        limits.check()
        self._offering: dict[int, list[int]] = {}
        for state, targets in enumerate(states):
            for event in targets:
                self._offering.setdefault(event, []).append(state)
        self._sources: list[list[int]] = [[] for _ in states]
        for state, targets in enumerate(states):
            for after in targets.values():
                for target in after:
                    self._sources[target].append(state)
        self.disturbing = cache(self._disturbing)
        self.enabling = cache(self._enabling)
        self._commute = cache(self._always_commute)
        self._ahead = cache(self._states_before)

    def _disturbing(self, state: int, event: int) -> tuple[int, ...]:
        """The events that may exclude an event offered in a state, or be excluded by it, before it happens: now, or
        after events that commute with it.
        """
        found: dict[int, None] = {}
        seen = {state}
        pending = [state]
        while pending:
            for other, targets in self._states[pending.pop()].items():
                if other == event:
                    continue
                if not self._commute(event, other):
                    found[other] = None
                    continue
                fresh = [target for target in targets if target not in seen]
                seen.update(fresh)
                pending += fresh
        return tuple(found)

    def _enabling(self, state: int, event: int) -> tuple[int, ...]:
        """The events of which at least one must happen before the component, in a state that refuses ``event``, offers
        it.
        """
        ahead = self._ahead(event)
        return tuple(
            other
            for other, targets in self._states[state].items()
            if any(target != state and target in ahead for target in targets)
        )

    def _always_commute(self, one: int, other: int) -> bool:
        """Whether, in every state that offers both, each leaves the other possible and their order makes
        no difference.
        """
        self._limits.check()
        for state in self._offering[one]:
            targets = self._states[state]
            if other not in targets:
                continue
            if len(targets[one]) > 1 or len(targets[other]) > 1:
                return False
            after_one = self._states[targets[one][0]].get(other, ())
            after_other = self._states[targets[other][0]].get(one, ())
            if len(after_one) != 1 or after_one != after_other:
                return False
        return True

    def _states_before(self, event: int) -> frozenset[int]:
        """The states from which one that offers the event can be reached."""
        return frozenset(reached(self._offering.get(event, ()), self._sources.__getitem__))
