"""Termination: in every run all processes end, whatever the environment offers, as long as it keeps
offering something.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import assert_never

from cspdiag.base.record import replaced
from cspdiag.proofs.portfolio import prove_deadlock_free
from cspdiag.proofs.properties.cycles import endless_run
from cspdiag.proofs.properties.endless import Finite
from cspdiag.proofs.transitions.systems.system import System
from cspdiag.proofs.verdict import LimitError, Limits, Proved, Refuted, Unknown, Verdict, among_reachable_states


def terminates(
    system: System,
    limits: Limits,
    deadlock_free: Callable[[System, Limits], Verdict] = prove_deadlock_free,
) -> Verdict:
    """Whether no run is infinite, and none stops before all processes have ended.

    A refutation has either a cycle, which can be repeated forever, or processes that are stuck. ``deadlock_free``
    answers the second question.
    """
    try:
        found = endless_run(system, range(len(system.events)), limits)
    except LimitError as stop:
        return Unknown("breadth-first", str(stop))
    if not isinstance(found, Finite):
        return Refuted(found.method, found.trace, cycle=found.cycle, states=found.states)
    verdict = deadlock_free(system, limits)
    if not isinstance(verdict, Proved):
        return verdict
    return replaced(verdict, reason=f"{_reason(found)}, and no deadlock: {verdict.reason}")


def _reason(found: Finite) -> str:
    match found.method:
        case "rules":
            return "no process can repeat anything"
        case "minimization":
            return "composed two at a time and minimized, the processes repeat nothing"
        case "sat" | "invariants" | "stubborn" | "breadth-first" | "spin":
            assert found.states is not None
            return f"no cycle {among_reachable_states(found.states)}"
        case _:
            assert_never(found.method)
