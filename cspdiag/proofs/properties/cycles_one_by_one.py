"""Cycles among all reachable states without numpy: the same answers as by vectors, though maybe with another cycle."""

from __future__ import annotations

from cspdiag.base.graphs import strong_components
from cspdiag.proofs.properties.endless import Endless, Finite, shortest_cycle
from cspdiag.proofs.search.closed_sets import ClosedSets
from cspdiag.proofs.search.one_by_one import explore
from cspdiag.proofs.transitions.systems.system import System
from cspdiag.proofs.verdict import Limits, Move


def among_all_states(system: System, part: System, limits: Limits) -> Endless | Finite:
    """A run that ends in a cycle of the steps of ``part``, or that there is none. Raises LimitError."""
    search = explore(system, limits, lambda state, can_step: ())
    sets = ClosedSets(part, limits)

    def onward(number: int) -> list[tuple[Move, int]]:
        limits.check()
        state = search.states[number]
        ways = [way for event in sets.possible(state) for way in sets.moves(state, event)]
        return [(move, search.numbers[after]) for move, after in ways]

    def following(number: int) -> list[int]:
        return [after for _, after in onward(number)]

    for component in strong_components(range(len(search.states)), following):
        members = set(component)
        if len(members) > 1 or component[0] in following(component[0]):
            start = min(members)
            ways = {number: [way for way in onward(number) if way[1] in members] for number in members}
            cycle = shortest_cycle(start, ways.__getitem__)
            return Endless("breadth-first", search.trace_to(start), cycle, len(search.states))
    return Finite("breadth-first", len(search.states))
