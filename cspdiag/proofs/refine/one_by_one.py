"""The search for a violation without numpy, one state after the other: the same answers as by vectors, later."""

from __future__ import annotations

from cspdiag.proofs.refine.followed import Followed, Searched
from cspdiag.proofs.refine.labels import END
from cspdiag.proofs.search.closed_sets import ClosedSets
from cspdiag.proofs.search.one_by_one import State, explore
from cspdiag.proofs.verdict import Limits


def violation(process: Followed, limits: Limits, *, failures: bool) -> Searched:
    """The first state found in which the process violates its specification. Raises LimitError."""
    sets = ClosedSets(process.system)
    watcher = len(process.system.components) - 1

    def violated(state: State, can_step: bool) -> tuple[int, ...]:
        return (watcher,) if _violates(process, sets, state, can_step, failures=failures) else ()

    search = explore(process.system, limits, violated)
    if search.found is None:
        return Searched(len(search.states))
    return Searched(len(search.states), search.trace_to(search.found), search.states[search.found])


def _violates(process: Followed, sets: ClosedSets, state: State, can_step: bool, *, failures: bool) -> bool:
    """Whether the process has done something forbidden in a state, or refuses there what it must offer."""
    at = state[-1]
    if at == len(process.nodes):
        return True
    node = process.nodes[at]
    ended = not can_step and process.has_ended(state)
    if ended and END not in node.after:
        return True
    if not failures or any(event not in process.seen for event in sets.possible(state)):
        return False
    offered = process.offers(state)
    offered |= {(port, None) for port, _ in offered}
    if ended:
        offered.add(END)
    return not any(accepted <= offered for accepted in node.acceptances)
