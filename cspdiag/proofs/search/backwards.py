"""Predecessors: which global states lead to a given one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product

from cspdiag.proofs.transitions.systems.system import INTERNAL, System
from cspdiag.proofs.verdict import Move


class Backwards:
    """The steps of a system backwards."""

    def __init__(self, system: System) -> None:
        self._events = system.events
        self._sources: list[dict[tuple[int, int], list[int]]] = []
        for component in system.components:
            sources: dict[tuple[int, int], list[int]] = {}
            for source, edges in enumerate(component.edges):
                for edge in dict.fromkeys(edges):
                    sources.setdefault(edge, []).append(source)
            self._sources.append(sources)

    def before(self, state: Sequence[int]) -> Iterator[tuple[Move, tuple[int, ...]]]:
        """Every move that leads to this state, and the state before it, reachable or not."""
        for at, sources in enumerate(self._sources):
            for source in sources.get((INTERNAL, state[at]), ()):
                yield Move(INTERNAL, ((at, state[at]),)), (*state[:at], source, *state[at + 1 :])
        for number, event in enumerate(self._events):
            choices = [self._sources[party].get((number, state[party]), ()) for party in event.parties]
            if not all(choices):
                continue
            move = Move(number, tuple((party, state[party]) for party in event.parties))
            for combination in product(*choices):
                earlier = list(state)
                for party, source in zip(event.parties, combination, strict=True):
                    earlier[party] = source
                yield move, tuple(earlier)
