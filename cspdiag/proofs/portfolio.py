"""The portfolio of proof methods: they are tried in order, the cheapest first, and the first that reaches a verdict
answers.

Tier 0 are the design rules, tier 1 is SAT, tier 2 SAT with invariants; they prove without search, and a candidate that
they cannot exclude guides a search for a trace. The searches follow: stubborn sets, compositional minimization, and
breadth-first search over all states.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import TypeAlias

from cspdiag.base.record import replaced
from cspdiag.proofs.sat.solver import MISSING
from cspdiag.proofs.search.candidates import MOST_STATES, refute_by_candidate
from cspdiag.proofs.structure.pairs import Structure
from cspdiag.proofs.structure.question import StuckQuestion
from cspdiag.proofs.transitions.systems.system import System
from cspdiag.proofs.verdict import LimitError, Limits, Method, Proved, Refuted, Unknown, Verdict

METHODS: tuple[Method, ...] = ("rules", "sat", "invariants", "stubborn", "minimization", "breadth-first")
"""The methods in the order in which they are tried."""

SHORTENING_SECONDS = 0.5
"""Processor time for finding the shortest trace after a longer one has been found without search."""

SMALL = 60
"""Only in systems with at most this number of components are traces shortened by search."""

BRIEF_SECONDS = 0.3
"""Processor time, at least, for a search before the solver for invariants is started; starting the solver alone takes
longer. The search may take as long as the methods before it, which is longer in large systems.
"""

STATES_OF_EXAMINATION = 1000
"""The number of states examined from a candidate that invariants may still exclude."""

Engine: TypeAlias = Callable[[StuckQuestion, Limits], Verdict]


def prove_deadlock_free(
    system: System, limits: Limits, methods: Sequence[Method] | None = None, structure: Structure | None = None
) -> Verdict:
    """Whether no reachable state is a deadlock, by the given methods or all of them, in order; ``structure`` saves work
    if it is known.
    """
    return _prove(StuckQuestion(system, together=True, known=structure or Structure(system, limits)), limits, methods)


def prove_knot_free(
    system: System, limits: Limits, methods: Sequence[Method] | None = None, structure: Structure | None = None
) -> Verdict:
    """Whether no set of processes is ever stuck forever, by the given methods or all of them, in order; ``structure``
    saves work if it is known.
    """
    return _prove(StuckQuestion(system, together=False, known=structure or Structure(system, limits)), limits, methods)


def _prove(question: StuckQuestion, limits: Limits, chosen: Sequence[Method] | None) -> Verdict:
    methods = chosen or METHODS
    began = time.process_time()
    unknown: list[Unknown] = []
    for at, method in enumerate(methods):
        if method == "invariants" and chosen is None:
            brief = _brief_search_verdict(question, limits, max(BRIEF_SECONDS, time.process_time() - began))
            if not isinstance(brief, Unknown):
                return _shortened(question, _with_solver_note(brief, unknown), limits)
        share = _share(limits, len(methods) - at)
        verdict = _verdict_of(method, question, share)
        if isinstance(verdict, Unknown):
            # A candidate of SAT may still be excluded by invariants: until then, only a cheap search starts from it.
            is_last = "invariants" not in methods[at + 1 :]
            verdict = _followed(question, verdict, share, MOST_STATES if is_last else 0)
        if not isinstance(verdict, Unknown):
            return _shortened(question, _with_solver_note(verdict, unknown), limits)
        unknown.append(verdict)
        if limits.remaining <= 0:
            break
    return _together(unknown)


def _verdict_of(method: Method, question: StuckQuestion, limits: Limits) -> Verdict:
    """The verdict of a method; the time includes what all methods need to know of the system."""
    try:
        return _ENGINES[method](question, limits)
    except LimitError as limit:
        return Unknown(method, str(limit))


def _with_solver_note(verdict: Verdict, unknown: Sequence[Unknown]) -> Verdict:
    """The verdict, with a note if a method was skipped because no solver is installed."""
    if isinstance(verdict, Proved) and any(before.reason == MISSING for before in unknown):
        return replaced(verdict, reason=f"{verdict.reason}; {MISSING}")
    return verdict


def _brief_search_verdict(question: StuckQuestion, limits: Limits, seconds: float) -> Verdict:
    """The verdict of a search that takes no more processor time than is given."""
    brief = Limits(min(seconds, limits.remaining), limits.memory, time.process_time)
    if question.structure.fails and not question.together:
        return _by_breadth_first(question, brief)
    return _by_stubborn_sets(question, brief)


def _followed(question: StuckQuestion, verdict: Unknown, limits: Limits, most_states: int) -> Verdict:
    """The verdict, or a refutation found from its candidate."""
    if verdict.candidate is None:
        return verdict
    found = refute_by_candidate(question, verdict.candidate, verdict.stuck, limits, verdict.method, most_states)
    return verdict if found is None else found


def _share(limits: Limits, methods: int) -> Limits:
    """Half of the time that is left, or all of it for the last method."""
    return limits.part(limits.remaining if methods == 1 else limits.remaining / 2)


def _together(unknown: Sequence[Unknown]) -> Unknown:
    """One verdict with the reasons of all methods, and the candidate of the last one that has a candidate."""
    last = next((verdict for verdict in reversed(unknown) if verdict.candidate is not None), unknown[-1])
    methods: dict[str, list[str]] = {}
    for verdict in unknown:
        methods.setdefault(verdict.reason, []).append(verdict.method)
    return replaced(last, reason="; ".join(f"{', '.join(names)}: {reason}" for reason, names in methods.items()))


def _shortened(question: StuckQuestion, verdict: Verdict, limits: Limits) -> Verdict:
    """A refutation with a shorter trace, if one is found quickly; any other verdict as it is."""
    if not isinstance(verdict, Refuted) or verdict.method == "breadth-first" or len(verdict.trace) < 2:
        return verdict
    if len(question.system.components) > SMALL:
        return verdict
    shorter = _by_breadth_first(
        question, Limits(min(SHORTENING_SECONDS, limits.remaining), limits.memory, time.process_time)
    )
    if isinstance(shorter, Refuted) and len(shorter.trace) < len(verdict.trace):
        return replaced(verdict, trace=shorter.trace, stuck=shorter.stuck)
    return verdict


def _by_rules(question: StuckQuestion, limits: Limits) -> Verdict:
    from cspdiag.proofs.rules.deadlock import by_rules

    return by_rules(question, limits)


def _by_sat(question: StuckQuestion, limits: Limits) -> Verdict:
    from cspdiag.proofs.sat.deadlock import by_sat

    return by_sat(question, limits)


def _by_invariants(question: StuckQuestion, limits: Limits) -> Verdict:
    from cspdiag.proofs.sat.invariants.prove import by_invariants

    def examine(candidate: Sequence[int], stuck: Sequence[int]) -> Refuted | None:
        return refute_by_candidate(question, candidate, stuck, limits, "invariants", STATES_OF_EXAMINATION)

    return by_invariants(question, limits, examine)


def _by_stubborn_sets(question: StuckQuestion, limits: Limits) -> Verdict:
    from cspdiag.proofs.search import stubborn

    if question.structure.fails and not question.together:
        # Stubborn sets do not preserve a knot that a failure may end.
        return Unknown("stubborn", "a missed sample or a fault may end the wait of those who seem stuck")
    search = stubborn.deadlock_free if question.together else stubborn.knot_free
    return search(question.system, limits)


def _by_minimization(question: StuckQuestion, limits: Limits) -> Verdict:
    from cspdiag.proofs.reduce import minimization

    search = minimization.deadlock_free if question.together else minimization.knot_free
    return search(question.system, limits)


def _by_breadth_first(question: StuckQuestion, limits: Limits) -> Verdict:
    from cspdiag.proofs.search import all_states

    search = all_states.deadlock_free if question.together else all_states.knot_free
    return search(question.system, limits)


_ENGINES: dict[Method, Engine] = {
    "rules": _by_rules,
    "sat": _by_sat,
    "invariants": _by_invariants,
    "stubborn": _by_stubborn_sets,
    "minimization": _by_minimization,
    "breadth-first": _by_breadth_first,
}
