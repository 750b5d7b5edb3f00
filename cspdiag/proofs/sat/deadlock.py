"""Tier 1: proof by SAT over the states that neighbours can be in together, refined by traps.

Each model of the formula is a candidate: a choice of states in which no component, or none of the stuck set, can
continue. The largest trap that a candidate leaves empty shows that it is unreachable, and gives a clause that excludes
it and similar ones. If no candidate remains the property is proved; a candidate that nothing excludes is passed on to a
search.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from cspdiag.proofs.sat.encoding import Encoding
from cspdiag.proofs.sat.solver import MISSING, Clause, Solver, SolverTimeoutError, find_solver
from cspdiag.proofs.structure.question import StuckQuestion
from cspdiag.proofs.verdict import LimitError, Limits, Method, Proved, Refuted, Unknown, Verdict

SMALL = 60
"""In systems with at most this number of components traps are made smaller before they are used."""

MOST_REFINEMENTS = 2000
"""The number of candidates that are excluded one by one before a method gives up."""

MOST_TRAPS = 100
"""The number of candidates that are excluded by traps alone; if more remain, invariants are needed."""

Refinement: TypeAlias = Callable[[StuckQuestion, Encoding, Sequence[int]], list[Clause]]
"""Clauses that exclude a candidate, given as the state of every component; none if it cannot."""

Beginning: TypeAlias = Callable[[Encoding], list[Clause]]
"""Clauses that hold in all reachable states."""

Examination: TypeAlias = Callable[[Sequence[int], Sequence[int]], Refuted | None]
"""A refutation found from a candidate and its stuck components; None if none was found."""

FIRST_EXAMINATION = 4
"""After this number of candidates that traps do not exclude one candidate is examined, then after twice as many, and so
on.
"""


def by_sat(question: StuckQuestion, limits: Limits) -> Proved | Unknown:
    """Proves the property by SAT and traps, or returns the candidate that is left."""
    verdict = refine(question, limits, [exclude_by_trap], "sat", most=MOST_TRAPS)
    assert not isinstance(verdict, Refuted), "no candidate is examined"
    return verdict


def refine(
    question: StuckQuestion,
    limits: Limits,
    refinements: Sequence[Refinement],
    method: Method,
    begin: Beginning | None = None,
    examine: Examination | None = None,
    known: int = 0,
    most: int = MOST_REFINEMENTS,
) -> Verdict:
    """Excludes candidates by ``refinements``, tried in order, until none is left, one cannot be excluded, or ``most``
    have been excluded.

    ``begin`` gives the clauses of ``known`` invariants, in addition to those of the encoding. ``examine`` is called
    with a candidate now and then, before it is excluded.
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
            return _Exclusion(question, limits, encoding, solver, refinements, method, most, examine).verdict(known)
        finally:
            solver.close()
    except SolverTimeoutError:
        return Unknown(method, f"the time limit of {limits.seconds:.3g} s was reached")
    except LimitError as limit:
        return Unknown(method, str(limit))


@dataclass
class _Exclusion:
    """Excludes candidates one by one; ``used`` counts how often each refinement has excluded one."""

    question: StuckQuestion
    limits: Limits
    encoding: Encoding
    solver: Solver
    refinements: Sequence[Refinement]
    method: Method
    most: int
    examine: Examination | None
    used: list[int] = field(init=False)
    examined_at: int = FIRST_EXAMINATION

    def __post_init__(self) -> None:
        self.used = [0] * len(self.refinements)

    def verdict(self, known: int) -> Verdict:
        """Proved if no goal has a candidate left; ``known`` is the number of invariants used from the start."""
        shapes, encoding = self.question.structure.shapes, self.encoding
        for component, goal in encoding.goals:
            if goal and encoding.left[component].isdisjoint(shapes[component].requesting):
                continue
            left = self.left(goal)
            if isinstance(left, Unknown) and left.candidate is not None:
                return self.nearest(goal, left)
            if left is not None:
                return left
            self.solver.add([[-literal for literal in goal]])
            if goal:
                excluded = self.question.waiting.exclude(component)
                self.solver.add([[-encoding.stuck[free]] for free in excluded if encoding.stuck[free]])
        return Proved(self.method, _reason(self.used[0], known + sum(self.used[1:])))

    def left(self, assumed: Clause) -> Refuted | Unknown | None:
        """The candidate that nothing excludes, or a refutation found from one; None if no candidate is left."""
        while (model := self.solver.solve(assumed)) is not None:
            self.limits.check()
            if sum(self.used) >= self.most:
                return Unknown(
                    self.method, f"states in which processes seem stuck were left after {self.most} refinements"
                )
            candidate, stuck = self.encoding.states(model), self.encoding.stuck_components(model)
            if self.examine is not None and sum(self.used[1:]) >= self.examined_at:
                self.examined_at *= 2
                found = self.examine(candidate, stuck)
                if found is not None:
                    return found
            for at, refinement in enumerate(self.refinements):
                if clauses := refinement(self.question, self.encoding, candidate):
                    self.used[at] += 1
                    self.solver.add(clauses)
                    break
            else:
                ended = f"the time limit of {self.limits.seconds:.3g} s was reached"
                reason = (
                    ended
                    if self.limits.remaining <= 0
                    else "a state in which processes seem stuck could not be ruled out"
                )
                return Unknown(self.method, reason, candidate, stuck)
        return None

    def nearest(self, goal: Clause, left: Unknown) -> Refuted | Unknown:
        """A candidate in which all components are as near to their initial states as possible: a trace to it is found
        more easily, and is short.
        """
        depth = 1
        while depth < self.encoding.deepest:
            near, clauses = self.encoding.within(depth)
            self.solver.add(clauses)
            try:
                nearer = self.left([*goal, near])
            except (LimitError, SolverTimeoutError):
                break
            if isinstance(nearer, Refuted) or (nearer is not None and nearer.candidate is not None):
                return nearer
            depth *= 2
        return left


def _reason(traps: int, invariants: int) -> str:
    helped = [f"{traps} trap{'s' if traps > 1 else ''}"] if traps else []
    helped += [f"{invariants} invariant{'s' if invariants > 1 else ''}"] if invariants else []
    also = f", and by {' and '.join(helped)}" if helped else ""
    return (
        f"every state in which a process would wait forever is ruled out by looking at two neighbours at a time{also}"
    )


def exclude_by_trap(question: StuckQuestion, encoding: Encoding, candidate: Sequence[int]) -> list[Clause]:
    """The clause of the largest trap that a candidate leaves empty; none if there is no such trap."""
    trap = question.traps.avoiding(candidate)
    if trap is None:
        return []
    if len(candidate) <= SMALL:
        trap = question.traps.smaller(trap)
    return [encoding.some_of(trap)]
