"""Compositional minimization: whether the machine that remains has a deadlock, after all processes have been composed
and minimized.

That machine shows only whether there is a deadlock or a knot; a separate search finds a trace to it.
"""

from __future__ import annotations

from collections.abc import Callable

from cspdiag.proofs.reduce.knots_as_deadlocks import knots_as_deadlocks
from cspdiag.proofs.reduce.parallel_machines import MOST_STATES, MachineInSystem
from cspdiag.proofs.reduce.reduction import Reduction
from cspdiag.proofs.search import all_states, stubborn
from cspdiag.proofs.transitions.systems.system import System
from cspdiag.proofs.verdict import LimitError, Limits, Proved, Refuted, Unknown, Verdict


def deadlock_free(system: System, limits: Limits) -> Verdict:
    """Whether no state is reachable in which nothing is possible and a process has not ended."""
    return _decide(system, system, limits, stubborn.deadlock_free, "the result has no deadlock")


def knot_free(system: System, limits: Limits) -> Verdict:
    """Whether no state is reachable in which some processes wait for each other forever, whatever the others do."""
    try:
        reduced = knots_as_deadlocks(system, limits)
    except LimitError as stop:
        return Unknown("minimization", str(stop))
    return _decide(system, reduced, limits, _some_knot, "none of them can be stuck")


def _some_knot(system: System, limits: Limits) -> Verdict:
    found = stubborn.knot_free(system, limits)
    return all_states.knot_free(system, limits) if isinstance(found, Unknown) else found


def _decide(
    system: System, reduced: System, limits: Limits, search: Callable[[System, Limits], Verdict], conclusion: str
) -> Verdict:
    """Whether the second system has no deadlock; if it has one, ``search`` finds the corresponding trace of
    the first.
    """
    try:
        reduction = Reduction(reduced, limits, only_deadlocks=True)
        remaining = list(reduction.remaining())
    except LimitError as stop:
        return Unknown("minimization", str(stop))
    if reduction.too_large:
        reason = f"no two of the last {len(remaining)} parts have at most {MOST_STATES} states together"
        return Unknown("minimization", reason)
    if not _can_deadlock(remaining):
        reason = f"composed two at a time and minimized, the processes never had more than {reduction.largest} states"
        return Proved("minimization", f"{reason}, and {conclusion}", reduction.largest)
    found = search(system, limits)
    if isinstance(found, Refuted):
        return found
    return Unknown("minimization", "some processes can be stuck, but the search for a trace to it reached a limit")


def _can_deadlock(parts: list[MachineInSystem]) -> bool:
    """Whether all parts, which share no events, can be without a step at once although some process has not ended."""
    ways = [
        {ended for ended, edges in zip(part.machine.ended, part.machine.edges, strict=True) if not edges}
        for part in parts
    ]
    return all(ways) and any(False in ended for ended in ways)
