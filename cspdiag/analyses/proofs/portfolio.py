"""The methods of proof in their order, the cheapest first: the first that knows answers.

Tier 0 are the design rules, tier 1 SAT, tier 2 SAT with invariants; they prove without search, and what they cannot exclude guides a search to a trace. Then come the
searches: stubborn sets, compositional minimization, and breadth-first over all states.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import log2
from typing import TypeAlias

from cspdiag.analyses.proofs.pairs import Structure
from cspdiag.analyses.proofs.question import Question
from cspdiag.analyses.proofs.verdict import Limits, Method, Proved, Refuted, Unknown, Verdict
from cspdiag.analyses.transitions.system import System

DEADLOCK_METHODS: tuple[Method, ...] = ("rules", "sat", "invariants", "stubborn", "minimization", "breadth-first")
"""The methods that decide freedom from deadlock, in their order."""

KNOT_METHODS: tuple[Method, ...] = ("rules", "sat", "invariants", "stubborn", "breadth-first")
"""The methods that decide freedom from knots, in their order."""

SHORTENING_SECONDS = 0.5
"""Time for finding the shortest trace, when a longer one has been found without search."""

SMALL = 60
"""Systems with at most so many components may have their traces shortened by search."""

FEW_STATES = 100_000
"""A system with at most so many combinations of states is searched before the solver for invariants would have started."""

Engine: TypeAlias = Callable[[Question, Limits], Verdict]


def prove_deadlock_free(
    system: System, limits: Limits, methods: Sequence[Method] | None = None, structure: Structure | None = None
) -> Verdict:
    """Whether no reachable state is a deadlock, by all methods in their order or by some of them; ``structure`` saves work where it is known."""
    return _prove(Question(system, together=True, known=structure), limits, methods, DEADLOCK_METHODS)


def prove_knot_free(
    system: System, limits: Limits, methods: Sequence[Method] | None = None, structure: Structure | None = None
) -> Verdict:
    """Whether no set of processes is ever stuck for ever, by all methods in their order or by some of them; ``structure`` as for deadlock."""
    return _prove(Question(system, together=False, known=structure), limits, methods, KNOT_METHODS)


def _prove(question: Question, limits: Limits, chosen: Sequence[Method] | None, methods: Sequence[Method]) -> Verdict:
    if chosen is not None:
        methods = chosen
    elif sum(log2(len(shape.reachable)) for shape in question.structure.shapes) <= log2(FEW_STATES):
        methods = [method for method in methods if method != "invariants"]
    unknown: list[Unknown] = []
    for at, method in enumerate(methods):
        share = _share(limits, len(methods) - at)
        verdict = _ENGINES[method](question, share)
        if isinstance(verdict, Unknown):
            # A candidate of SAT may still be excluded by invariants: only what costs little is tried with it before.
            is_last = "invariants" not in methods[at + 1 :]
            verdict = _followed(question, verdict, share, thorough=is_last)
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


def _followed(question: Question, verdict: Unknown, limits: Limits, *, thorough: bool) -> Verdict:
    """The verdict, or a refutation that its candidate leads to."""
    if verdict.candidate is None:
        return verdict
    from cspdiag.analyses.proofs.candidates import refute_by_candidate

    found = refute_by_candidate(question, verdict.candidate, verdict.stuck, limits, verdict.method, thorough=thorough)
    return verdict if found is None else found


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

    return by_sat(question, limits)


def _by_invariants(question: Question, limits: Limits) -> Verdict:
    from cspdiag.analyses.proofs.invariants import by_invariants

    return by_invariants(question, limits)


def _by_stubborn_sets(question: Question, limits: Limits) -> Verdict:
    from cspdiag.analyses.proofs import stubborn

    if question.structure.fails and not question.together:
        # A knot that a failure ends is not kept by what stubborn sets leave out.
        return Unknown("stubborn", "a failure may end what is stuck")
    search = stubborn.deadlock_free if question.together else stubborn.knot_free
    return search(question.system, limits)


def _by_minimization(question: Question, limits: Limits) -> Verdict:
    from cspdiag.analyses.proofs import minimization

    search = minimization.deadlock_free if question.together else minimization.knot_free
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
    "minimization": _by_minimization,
    "breadth-first": _by_breadth_first,
}
