"""An invariant as clauses: the weights of the states that are taken sum to at most 0."""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.analyses.proofs.invariants_problem import Weights
from cspdiag.analyses.proofs.sat_encoding import Encoding
from cspdiag.analyses.proofs.sat_solver import Clause

MOST_SUMS = 20_000
"""Invariants with more partial sums than this are not made clauses."""


def at_most(encoding: Encoding, weights: Weights) -> list[Clause]:
    """Clauses that the sum of the weights is at most 0, with one variable for every partial sum (Eén and Sörensson, 2006); none if there were too many."""
    members = [(variables, weight) for variables, weight in zip(encoding.variables, weights, strict=True) if weight]
    values = [_by_value(variables, weight) for variables, weight in members]
    # least[k], most[k]: of the sums of the members from k on.
    least, most = [0], [0]
    for choices in reversed(values):
        least.append(least[-1] + min(choices))
        most.append(most[-1] + max(choices))
    least.reverse()
    most.reverse()
    clauses: list[Clause] = []
    sums: dict[int, int | None] = {0: None}
    total = 0
    for at, choices in enumerate(values):
        following: dict[int, int | None] = {}
        for reached, here in sums.items():
            for value, variables in choices.items():
                then = reached + value
                if then + most[at + 1] <= 0:
                    continue
                clause = [] if here is None else [-here]
                if then + least[at + 1] <= 0:
                    if then not in following:
                        following[then] = encoding.fresh()
                    clause.append(following[then] or 0)
                clauses += [[-variable, *clause] for variable in variables]
        sums = following
        total += len(sums)
        if total > MOST_SUMS:
            return []
    return clauses


def _by_value(variables: dict[int, int], weight: dict[int, int]) -> dict[int, list[int]]:
    values: dict[int, list[int]] = {}
    for state, variable in variables.items():
        values.setdefault(weight.get(state, 0), []).append(variable)
    return values


def excluding(encoding: Encoding, weights: Weights, candidate: Sequence[int]) -> Clause:
    """The clause that excludes a candidate which violates the invariant, and all that agree with it where there are weights."""
    return [
        -variables[state]
        for variables, weight, state in zip(encoding.variables, weights, candidate, strict=True)
        if weight
    ]
