"""Termination: every run comes to an end in which all processes have ended, whatever the environment offers, provided it does not stop offering."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from cspdiag.analyses.proofs import stubborn
from cspdiag.analyses.proofs.cycles import Finite, endless_run
from cspdiag.analyses.proofs.verdict import LimitError, Limits, Proved, Refuted, Unknown, Verdict
from cspdiag.analyses.transitions.system import System


def terminates(
    system: System,
    limits: Limits,
    deadlock_free: Callable[[System, Limits], Verdict] = stubborn.deadlock_free,
) -> Verdict:
    """Whether no run is infinite, and none stops where a process has not ended.

    A refutation has either a cycle, which can be repeated for ever, or processes that are stuck. ``deadlock_free`` answers the second question.
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
    why = (
        "no process can repeat anything"
        if found.states is None
        else f"no cycle among the {found.states} reachable states"
    )
    return replace(verdict, reason=f"{why}, and no deadlock: {verdict.reason}")
