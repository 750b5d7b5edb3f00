"""Invariants as clauses: the weights of the chosen states sum to at most 0, or to exactly 0."""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.proofs.sat.encoding import Encoding
from cspdiag.proofs.sat.invariants.problem import Weights
from cspdiag.proofs.sat.solver import Clause

MOST_SUMS = 100_000
"""Invariants with more partial sums than this are not turned into clauses."""


def sum_clauses(encoding: Encoding, weights: Weights, *, equal: bool = False) -> list[Clause]:
    """Clauses that the sum of the weights is at most 0, or with ``equal`` exactly 0; none if there would be too many.

    Every partial sum that matters has a variable (Eén and Sörensson, "Translating pseudo-Boolean constraints into SAT",
    2006).
    """
    values = [_by_value(encoding.variables[component], weight) for component, weight in weights.items()]
    if not all(values):
        return []  # A component has no state left to be in: there is no model anyway.
    # least[k], most[k]: bounds of the sum of the weights from component k on.
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
                lowest, highest = then + least[at + 1], then + most[at + 1]
                if highest <= 0 and (lowest >= 0 or not equal):
                    continue
                clause = [] if here is None else [-here]
                if lowest <= 0 and (highest >= 0 or not equal):
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
    """The clause that excludes a candidate that violates the invariant, and all candidates with the same states of the
    components that have weights.
    """
    return [-encoding.variables[component][candidate[component]] for component in weights]
