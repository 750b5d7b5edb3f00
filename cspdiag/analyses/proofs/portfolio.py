"""The methods of proof in their order, the cheapest first: the first that knows answers.

Tier 0 are the design rules, tier 1 SAT, tier 2 SAT with invariants; they prove without search, and what they cannot exclude guides a search to a trace. Then come the
searches: with stubborn sets, and breadth-first over all states.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeAlias

from cspdiag.analyses.proofs.pairs import Structure
from cspdiag.analyses.proofs.question import Question
from cspdiag.analyses.proofs.verdict import Limits, Method, Proved, Refuted, Unknown, Verdict
from cspdiag.analyses.transitions.system import System

DEADLOCK_METHODS: tuple[Method, ...] = ("rules", "sat", "invariants", "stubborn", "breadth-first")
"""The methods that decide freedom from deadlock, in their order."""

KNOT_METHODS: tuple[Method, ...] = ("rules", "sat", "invariants", "stubborn", "breadth-first")
"""The methods that decide freedom from knots, in their order."""

SHORTENING_SECONDS = 0.5
"""Time for finding the shortest trace, when a longer one has been found without search."""

SMALL = 60
"""Systems with at most so many components may have their traces shortened by search."""

Engine: TypeAlias = Callable[[Question, Limits], Verdict]


def prove_deadlock_free(
    system: System, limits: Limits, methods: Sequence[Method] | None = None, structure: Structure | None = None
) -> Verdict:
    """Whether no reachable state is a deadlock, by all methods in their order or by some of them; ``structure`` saves work where it is known."""
    return _prove(Question(system, together=True, known=structure), limits, methods or DEADLOCK_METHODS)


def prove_knot_free(
    system: System, limits: Limits, methods: Sequence[Method] | None = None, structure: Structure | None = None
) -> Verdict:
    """Whether no set of processes is ever stuck for ever, by all methods in their order or by some of them; ``structure`` as for deadlock."""
    return _prove(Question(system, together=False, known=structure), limits, methods or KNOT_METHODS)


def _prove(question: Question, limits: Limits, methods: Sequence[Method]) -> Verdict:
    unknown: list[Unknown] = []
    for at, method in enumerate(methods):
        verdict = _ENGINES[method](question, _share(limits, len(methods) - at))
        match verdict:
            case Proved():
                return verdict
            case Refuted():
                return _shortened(question, verdict, limits)
            case Unknown():
                unknown.append(verdict)
        if limits.remaining <= 0:
            break
    return _together(unknown)


def _share(limits: Limits, methods: int) -> Limits:
    """Half of the time that is left, or all of it for the last method."""
    return Limits(limits.remaining if methods == 1 else limits.remaining / 2, limits.memory)


def _together(unknown: Sequence[Unknown]) -> Unknown:
    """Why no method knows; the candidate of the last that has one."""
    last = next((verdict for verdict in reversed(unknown) if verdict.candidate is not None), unknown[-1])
    return replace(last, reason="; ".join(f"{verdict.method}: {verdict.reason}" for verdict in unknown))


def _shortened(question: Question, verdict: Refuted, limits: Limits) -> Refuted:
    """The refutation with a shorter trace, if one is found quickly."""
    if verdict.method == "breadth-first" or len(question.system.components) > SMALL or len(verdict.trace) < 2:
        return verdict
    seconds = min(SHORTENING_SECONDS, limits.remaining)
    shorter = _by_breadth_first(question, Limits(seconds, limits.memory))
    if isinstance(shorter, Refuted) and len(shorter.trace) < len(verdict.trace):
        return replace(verdict, trace=shorter.trace, stuck=shorter.stuck)
    return verdict


def _by_rules(question: Question, limits: Limits) -> Verdict:
    from cspdiag.analyses.proofs.rules import by_rules

    return by_rules(question, limits)


def _by_sat(question: Question, limits: Limits) -> Verdict:
    from cspdiag.analyses.proofs.sat import by_sat

    return _followed(question, by_sat(question, limits), limits)


def _by_invariants(question: Question, limits: Limits) -> Verdict:
    from cspdiag.analyses.proofs.invariants import by_invariants

    return _followed(question, by_invariants(question, limits), limits)


def _followed(question: Question, verdict: Proved | Unknown, limits: Limits) -> Verdict:
    """The verdict, or a refutation that its candidate leads to."""
    from cspdiag.analyses.proofs.candidates import refute_by_candidate

    if isinstance(verdict, Proved) or verdict.candidate is None:
        return verdict
    found = refute_by_candidate(question, verdict.candidate, verdict.stuck, limits, verdict.method)
    return verdict if found is None else found


def _by_stubborn_sets(question: Question, limits: Limits) -> Verdict:
    from cspdiag.analyses.proofs import stubborn

    search = stubborn.deadlock_free if question.together else stubborn.knot_free
    return search(question.system, limits)


def _by_breadth_first(question: Question, limits: Limits) -> Verdict:
    from cspdiag.analyses.proofs import breadth_first

    search = breadth_first.deadlock_free if question.together else breadth_first.knot_free
    return search(question.system, limits)


_ENGINES: dict[Method, Engine] = {
    "rules": _by_rules,
    "sat": _by_sat,
    "invariants": _by_invariants,
    "stubborn": _by_stubborn_sets,
    "breadth-first": _by_breadth_first,
}
