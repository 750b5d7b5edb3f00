"""Tier 2: proof by SAT and traps, refined by linear invariants.

The places of a network (the states of its components) carry weights. Weights whose sum no step changes become clauses
from the start (``invariants.basis``). If no step increases the sum, a candidate with a greater sum than the initial
state is unreachable: a rational solution of the dual of the marking equation (Murata, "Petri nets: properties, analysis
and applications", 1989, sections IV and V; Esparza and Melzer, 2000). Such weights come from a solver that computes
with floating-point numbers, in a process of its own; they are made rational, and used only if the condition holds
exactly for every step.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import lcm

from cspdiag.proofs.sat.deadlock import Examination, exclude_by_trap, refine
from cspdiag.proofs.sat.encoding import Encoding
from cspdiag.proofs.sat.invariants.basis import invariants_with_equality
from cspdiag.proofs.sat.invariants.encoding import excluding, sum_clauses
from cspdiag.proofs.sat.invariants.problem import Problem, Weights, problem_of
from cspdiag.proofs.sat.invariants.process import WeightsProcess
from cspdiag.proofs.sat.solver import Clause
from cspdiag.proofs.structure.question import StuckQuestion
from cspdiag.proofs.verdict import LimitError, Limits, Unknown, Verdict

LARGEST_PROBLEM = 50_000
"""In systems with more edges than this no solver searches for further weights."""

DENOMINATORS = (1, 2, 6, 12, 60, 2520)
"""Weights are rounded to fractions with denominators up to each of these in turn."""


def by_invariants(question: StuckQuestion, limits: Limits, examine: Examination | None = None) -> Verdict:
    """Proves the property by SAT, traps and invariants, or returns the candidate that is left.

    ``examine`` may find a refutation from a candidate before all are excluded. Invariants that were found for another
    question about the same system are used again.
    """
    structure = question.structure
    problem = problem_of(structure)
    known: list[Weights] = structure.cached("invariants", list)
    try:
        balanced = structure.cached("balanced", lambda: invariants_with_equality(structure, limits))
    except LimitError as limit:
        return Unknown("invariants", str(limit))

    def begin(encoding: Encoding) -> list[Clause]:
        clauses = [clause for weights in balanced for clause in sum_clauses(encoding, weights, equal=True)]
        return clauses + [clause for weights in known for clause in sum_clauses(encoding, weights)]

    with WeightsProcess(problem, limits) as process:

        def exclude(question: StuckQuestion, encoding: Encoding, candidate: Sequence[int]) -> list[Clause]:
            weights = _exact(problem, process.weights(candidate), candidate)
            if weights is None:
                return []
            known.append(weights)
            return sum_clauses(encoding, weights) or [excluding(encoding, weights, candidate)]

        refinements = [exclude_by_trap, exclude] if problem.size <= LARGEST_PROBLEM else [exclude_by_trap]
        invariants = len(balanced) + len(known)
        return refine(question, limits, refinements, "invariants", begin, examine, invariants)


def _exact(problem: Problem, found: Sequence[float] | None, candidate: Sequence[int]) -> Weights | None:
    """The weights as whole numbers; None if they do not exactly exclude the candidate."""
    if found is None:
        return None
    for denominator in DENOMINATORS:
        fractions = [Fraction(value).limit_denominator(denominator) for value in found]
        scale = lcm(*(value.denominator for value in fractions))
        weights = problem.by_state([int(value * scale) for value in fractions])
        if problem.never_increases(weights) and problem.excess(weights, candidate) > 0:
            return weights
    return None
