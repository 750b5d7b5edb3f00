"""Livelock: a run that from some point on has only events that are invisible outside, and in which no time passes
(divergence: Roscoe, "Understanding Concurrent Systems", section 6.1).
"""

from __future__ import annotations

from typing import assert_never

from cspdiag.proofs.properties.cycles import endless_run
from cspdiag.proofs.properties.endless import Finite
from cspdiag.proofs.transitions.systems.system import Event, System
from cspdiag.proofs.verdict import LimitError, Limits, Proved, Refuted, Unknown, Verdict, among_reachable_states

_SEEN_OUTSIDE = ("external", "sample", "miss", "time")


def is_hidden(event: Event) -> bool:
    """Whether an event neither communicates on a port of the outermost process, nor involves the environment, nor lets
    time pass.
    """
    return not event.visible and (event.kind not in _SEEN_OUTSIDE or event.instant)


def livelock_free(system: System, limits: Limits) -> Verdict:
    """Whether no run continues forever with communications among the processes and internal steps only."""
    hidden = [number for number, event in enumerate(system.events) if is_hidden(event)]
    try:
        found = endless_run(system, hidden, limits)
    except LimitError as stop:
        return Unknown("breadth-first", str(stop))
    if isinstance(found, Finite):
        return Proved(found.method, _reason(found), found.states)
    return Refuted(found.method, found.trace, cycle=found.cycle, states=found.states)


def _reason(found: Finite) -> str:
    match found.method:
        case "rules":
            return "every loop waits for the environment or for time, in at least one process that takes part"
        case "minimization":
            return "composed two at a time and minimized, the processes have no loop without the environment or time"
        case "sat" | "invariants" | "stubborn" | "breadth-first" | "spin":
            assert found.states is not None
            return f"every cycle {among_reachable_states(found.states)} involves the environment or time"
        case _:
            assert_never(found.method)
