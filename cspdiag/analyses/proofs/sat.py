"""Tier 1: proof by SAT over what neighbours can be doing together, refined by traps.

Each model of the formula is a candidate: a choice of states in which nothing, or nothing in the stuck set, could go on. The largest trap that a candidate leaves empty
shows that it is not reachable and gives a clause that excludes it and its like. Without candidates the property is proved; a candidate that nothing
excludes is handed on to a search.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

from cspdiag.analyses.proofs.question import Question
from cspdiag.analyses.proofs.sat_encoding import Encoding
from cspdiag.analyses.proofs.sat_solver import MISSING, Clause, Solver, SolverTimeoutError, find_solver
from cspdiag.analyses.proofs.verdict import LimitError, Limits, Method, Proved, Refuted, Unknown, Verdict

SMALL = 60
"""Traps of systems with at most so many components are made smaller before they are used."""

MOST_REFINEMENTS = 2000
"""Candidates that are excluded one by one before the method gives up."""

Refinement: TypeAlias = Callable[[Question, Encoding, Sequence[int]], list[Clause]]
"""Clauses that exclude a candidate, given as the state of every component; none if it cannot."""

Beginning: TypeAlias = Callable[[Encoding], list[Clause]]
"""Clauses that are true of what is reachable."""

Examination: TypeAlias = Callable[[Sequence[int], Sequence[int]], Refuted | None]
"""A refutation that a candidate and its stuck components lead to."""

FIRST_EXAMINATION = 4
"""After so many candidates that traps do not exclude one is examined, then after twice as many, and so on."""


def by_sat(question: Question, limits: Limits) -> Proved | Unknown:
    """Prove the property by SAT and traps, or give the candidate that is left."""
    verdict = refine(question, limits, [exclude_by_trap], "sat")
    assert not isinstance(verdict, Refuted), "nobody examines candidates"
    return verdict


def refine(
    question: Question,
    limits: Limits,
    refinements: Sequence[Refinement],
    method: Method,
    begin: Beginning | None = None,
    examine: Examination | None = None,
    known: int = 0,
) -> Verdict:
    """Exclude candidates by ``refinements``, tried in their order, until none is left or one stays.

    ``begin`` gives clauses of ``known`` invariants, that hold beside those of the encoding. ``examine`` is shown a candidate now and then, before it is excluded.
    """
    create = find_solver()
    if create is None:
        return Unknown(method, MISSING)
    try:
        encoding = Encoding(question.structure, question.waiting, together=question.together)
        solver = create(limits.remaining)
        try:
            solver.add(encoding.clauses)
            if begin is not None:
                solver.add(begin(encoding))
            return _exclude_all(question, limits, encoding, solver, refinements, method, examine, known)
        finally:
            solver.close()
    except SolverTimeoutError:
        return Unknown(method, f"the time limit of {limits.seconds:.3g} s was reached")
    except LimitError as limit:
        return Unknown(method, str(limit))


def _exclude_all(
    question: Question,
    limits: Limits,
    encoding: Encoding,
    solver: Solver,
    refinements: Sequence[Refinement],
    method: Method,
    examine: Examination | None,
    known: int,
) -> Verdict:
    used = [0] * len(refinements)
    examined_at = FIRST_EXAMINATION
    for component, goal in encoding.goals:
        if goal and encoding.left[component].isdisjoint(question.structure.shapes[component].asking):
            continue
        while (model := solver.solve(goal)) is not None:
            limits.check()
            if sum(used) >= MOST_REFINEMENTS:
                return Unknown(method, f"candidates were left after {MOST_REFINEMENTS} refinements")
            candidate, stuck = encoding.states(model), encoding.stuck_components(model)
            if examine is not None and sum(used[1:]) >= examined_at:
                examined_at *= 2
                found = examine(candidate, stuck)
                if found is not None:
                    return found
            for at, refinement in enumerate(refinements):
                if clauses := refinement(question, encoding, candidate):
                    used[at] += 1
                    solver.add(clauses)
                    break
            else:
                ended = f"the time limit of {limits.seconds:.3g} s was reached"
                reason = ended if limits.remaining <= 0 else "a candidate could not be excluded"
                return Unknown(method, reason, candidate, stuck)
        solver.add([[-literal for literal in goal]])
        if goal:
            solver.add(
                [[-encoding.stuck[free]] for free in question.waiting.exclude(component) if encoding.stuck[free]]
            )
    return Proved(method, _reason(used[0], known + sum(used[1:])))


def _reason(traps: int, invariants: int) -> str:
    helped = [f"{traps} trap{'s' if traps > 1 else ''}"] if traps else []
    helped += [f"{invariants} invariant{'s' if invariants > 1 else ''}"] if invariants else []
    limits = f", and that {' and '.join(helped)} allow{'s' if traps + invariants == 1 else ''}," if helped else ""
    return f"in no states that neighbours can be in together{limits} would anybody wait for ever"


def exclude_by_trap(question: Question, encoding: Encoding, candidate: Sequence[int]) -> list[Clause]:
    """The clause of the largest trap that a candidate leaves empty, if there is one."""
    trap = question.traps.avoiding(candidate)
    if trap is None:
        return []
    if len(candidate) <= SMALL:
        trap = question.traps.smaller(trap)
    return [encoding.some_of(trap)]
