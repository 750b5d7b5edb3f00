"""Tier 2: proof by SAT, traps and invariants."""

from __future__ import annotations

from cspdiag.analyses.proofs.question import Question
from cspdiag.analyses.proofs.sat import exclude_by_trap, refine
from cspdiag.analyses.proofs.verdict import Limits, Proved, Unknown


def by_invariants(question: Question, limits: Limits) -> Proved | Unknown:
    """Prove the property by SAT, traps and invariants, or give the candidate that is left."""
    return refine(question, limits, [exclude_by_trap], "invariants")
