"""Tier 1: proof by SAT over what neighbours can be doing together, refined by traps.

Each model of the formula is a candidate: a choice of states in which nothing, or nothing in the stuck set, could go on. The largest trap that a candidate leaves empty
shows that it is not reachable and gives a clause that excludes it and its like. Without candidates the property is proved; a candidate that nothing
excludes is handed on to a search.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

from cspdiag.analyses.proofs.pairs import Structure
from cspdiag.analyses.proofs.rules_waiting import Waiting, waiting_states
from cspdiag.analyses.proofs.sat_encoding import Encoding
from cspdiag.analyses.proofs.sat_solver import Clause, Solver, SolverTimeoutError, find_solver
from cspdiag.analyses.proofs.traps import Traps
from cspdiag.analyses.proofs.verdict import LimitError, Limits, Method, Proved, Unknown
from cspdiag.analyses.transitions.system import System

SMALL = 60
"""Traps of systems with at most so many components are made smaller before they are used."""

MOST_REFINEMENTS = 2000
"""Candidates that are excluded one by one before the method gives up."""

Refinement: TypeAlias = Callable[["Question", Encoding, Sequence[int]], list[Clause]]
"""Clauses that exclude a candidate, given as the state of every component; none if it cannot."""


@dataclass(frozen=True)
class Question:
    """Deadlock freedom (``together``: all components wait) or freedom from knots of a system, with what several methods use."""

    system: System
    together: bool

    @cached_property
    def structure(self) -> Structure:
        """The system by shapes and pairs."""
        return Structure(self.system)

    @cached_property
    def waiting(self) -> Waiting:
        """The waiting states that are not excluded by orders of waiting."""
        return waiting_states(self.structure, together=self.together)

    @cached_property
    def traps(self) -> Traps:
        """The traps of the system."""
        return Traps(self.structure)


def by_sat(question: Question, limits: Limits) -> Proved | Unknown:
    """Prove the property by SAT and traps, or give the candidate that is left."""
    return refine(question, limits, [exclude_by_trap], "sat")


def refine(question: Question, limits: Limits, refinements: Sequence[Refinement], method: Method) -> Proved | Unknown:
    """Exclude candidates by ``refinements``, tried in their order, until none is left or one stays."""
    create = find_solver()
    if create is None:
        return Unknown(method, "no SAT solver is installed (pip install 'cspdiag[verify]')")
    try:
        encoding = Encoding(question.structure, question.waiting, together=question.together)
        solver = create(limits.seconds - (time.monotonic() - limits.started))
        try:
            return _exclude_all(question, limits, encoding, solver, refinements, method)
        finally:
            solver.close()
    except SolverTimeoutError:
        return Unknown(method, f"the time limit of {limits.seconds:g} s was reached")
    except LimitError as limit:
        return Unknown(method, str(limit))


def _exclude_all(
    question: Question,
    limits: Limits,
    encoding: Encoding,
    solver: Solver,
    refinements: Sequence[Refinement],
    method: Method,
) -> Proved | Unknown:
    solver.add(encoding.clauses)
    used = [0] * len(refinements)
    for goal in encoding.goals:
        while (model := solver.solve(goal)) is not None:
            limits.check()
            if sum(used) >= MOST_REFINEMENTS:
                return Unknown(method, f"candidates were left after {MOST_REFINEMENTS} refinements")
            candidate = encoding.states(model)
            for at, refinement in enumerate(refinements):
                if clauses := refinement(question, encoding, candidate):
                    used[at] += 1
                    solver.add(clauses)
                    break
            else:
                return Unknown(method, "a candidate could not be excluded", candidate, encoding.stuck_components(model))
        solver.add([[-literal for literal in goal]])
    return Proved(method, _reason(question, used))


def _reason(question: Question, used: Sequence[int]) -> str:
    return f"{used}"


def exclude_by_trap(question: Question, encoding: Encoding, candidate: Sequence[int]) -> list[Clause]:
    """The clause of the largest trap that a candidate leaves empty, if there is one."""
    trap = question.traps.avoiding(candidate)
    if trap is None:
        return []
    if len(candidate) <= SMALL:
        trap = question.traps.smaller(trap)
    return [encoding.some_of(trap)]
