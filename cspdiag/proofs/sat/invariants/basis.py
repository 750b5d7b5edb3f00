"""The linear invariants that hold with equality: a basis of all of them, computed exactly and sparsely.

The weight of a state of a component is the sum of what the steps on a path to it add. An event adds an amount of its
own to each of its parties, and the amounts of all parties sum to zero; a step that a component takes alone adds
nothing. This gives an equation for every cycle in the graph of a component, the same one for all components of one
shape. The solutions are the P-invariants of the network (Murata, "Petri nets: properties, analysis and applications",
1989, section V).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from math import gcd, lcm
from typing import TypeAlias

from cspdiag.base.record import record
from cspdiag.proofs.sat.invariants.problem import Weights
from cspdiag.proofs.structure.pairs import Shape, Structure
from cspdiag.proofs.transitions.systems.system import INTERNAL
from cspdiag.proofs.verdict import Limits

Sum: TypeAlias = dict[int, Fraction]
"""A linear combination: unknowns with their coefficients, none of which is 0."""

Counts: TypeAlias = dict[int, int]
"""How often a path takes each event of a shape forwards, minus how often it takes it backwards."""

ONE = Fraction(1)


@record
class _Paths:
    """For a shape: a path from the initial state to every other state, and the counts of each cycle that another edge
    closes.
    """

    to: dict[int, Counts]
    circles: tuple[Counts, ...]


def invariants_with_equality(structure: Structure, limits: Limits) -> list[Weights]:
    """Invariants: weights of states, 0 for every initial state, whose sum is 0 in every reachable state. Raises
    LimitError.
    """
    of_shape = {id(shape): shape for shape in structure.shapes}
    known = {key: _paths(shape) for key, shape in of_shape.items()}
    paths = [known[id(shape)] for shape in structure.shapes]
    added = _added(structure)
    equations = {
        tuple(sorted(equation.items())): None
        for sums, of in zip(added, paths, strict=True)
        for circle in of.circles
        if (equation := _combined((Fraction(count), sums[event]) for event, count in circle.items()))
    }
    solved = _solved([dict(equation) for equation in sorted(equations, key=len)], limits)
    return list(_invariants(paths, added, solved, limits))


def _paths(shape: Shape) -> _Paths:
    neighbours: dict[int, list[tuple[int, Counts]]] = {state: [] for state in shape.reachable}
    edges: list[tuple[int, Counts, int]] = []
    for state in shape.reachable:
        for event, after in shape.edges[state]:
            own = event == INTERNAL or event in shape.alone
            edges.append((state, {} if own else {event: 1}, after))
            neighbours[state].append((after, {} if own else {event: 1}))
            neighbours[after].append((state, {} if own else {event: -1}))
    to: dict[int, Counts] = {shape.initial: {}}
    pending = [shape.initial]
    for state in pending:
        for other, step in neighbours[state]:
            if other not in to:
                to[other] = _plus(to[state], step)
                pending.append(other)
    differences = (_plus(_plus(to[state], step), to[after], -1) for state, step, after in edges)
    circles = {tuple(sorted(difference.items())): None for difference in differences if difference}
    return _Paths(to, tuple(dict(circle) for circle in circles))


def _plus(one: Counts, other: Counts, sign: int = 1) -> Counts:
    result = dict(one)
    for event, count in other.items():
        result[event] = result.get(event, 0) + sign * count
        if not result[event]:
            del result[event]
    return result


def _added(structure: Structure) -> list[dict[int, Sum]]:
    """What each event of the shape of a component adds to it, for every component, in terms of unknowns.

    An event that one of its parties never offers never happens, so what it adds to the others need not sum to 0.
    """
    offered = {id(shape): {event for edges in shape.offers for event in edges} for shape in structure.shapes}
    added: list[dict[int, Sum]] = [{} for _ in structure.shapes]
    unknown = 0
    for roles in structure.roles:
        offering = [(party, number) for party, number in roles if number in offered[id(structure.shapes[party])]]
        free = offering[:-1] if len(offering) == len(roles) else offering
        for party, number in free:
            added[party][number] = {unknown: ONE}
            unknown += 1
        for party, number in offering[len(free) :]:
            added[party][number] = {unknown - at: -ONE for at in range(1, len(free) + 1)}
    return added


def _combined(parts: Iterable[tuple[Fraction, Sum]]) -> Sum:
    result: Sum = {}
    for factor, part in parts:
        for unknown, coefficient in part.items():
            value = result.get(unknown, 0) + factor * coefficient
            if value:
                result[unknown] = value
            else:
                result.pop(unknown, None)
    return result


def _solved(equations: Iterable[Sum], limits: Limits) -> dict[int, Sum]:
    """The bound unknowns in terms of the free ones, so that the given sums are 0 (Gauss-Jordan elimination)."""
    solved: dict[int, Sum] = {}
    for equation in equations:
        limits.check()
        left = equation
        while not solved.keys().isdisjoint(left):
            left = _substituted(left, solved)
        if left:
            unknown = max(left, key=lambda one: (abs(left[one]) == 1, one))
            factor = -1 / left.pop(unknown)
            solved[unknown] = {other: factor * coefficient for other, coefficient in left.items()}
    for unknown in reversed(solved):
        limits.check()
        solved[unknown] = _substituted(solved[unknown], solved)
    return solved


def _substituted(one: Sum, solved: dict[int, Sum]) -> Sum:
    return _combined((coefficient, solved.get(unknown, {unknown: ONE})) for unknown, coefficient in one.items())


def _invariants(
    paths: Sequence[_Paths], added: Sequence[dict[int, Sum]], solved: dict[int, Sum], limits: Limits
) -> Iterator[Weights]:
    """The weights for each free unknown, with that unknown 1 and the others 0."""
    # For each free unknown and component, what each event adds.
    choices: dict[int, dict[int, dict[int, Fraction]]] = {}
    for component, sums in enumerate(added):
        for event, amount in sums.items():
            for chosen, coefficient in _substituted(amount, solved).items():
                choices.setdefault(chosen, {}).setdefault(component, {})[event] = coefficient
    for concerned in choices.values():
        limits.check()
        weights: dict[int, dict[int, Fraction]] = {}
        for component, amounts in concerned.items():
            reached = {
                state: sum((amounts[event] * count for event, count in path.items() if event in amounts), Fraction(0))
                for state, path in paths[component].to.items()
            }
            if weight := {state: value for state, value in reached.items() if value}:
                weights[component] = weight
        if weights:
            yield _whole(weights)


def _whole(weights: dict[int, dict[int, Fraction]]) -> Weights:
    """The weights as the smallest whole numbers in the same proportions."""
    values = [value for weight in weights.values() for value in weight.values()]
    scale = Fraction(lcm(*(value.denominator for value in values)), gcd(*(value.numerator for value in values)))
    return {
        component: {state: int(value * scale) for state, value in weight.items()}
        for component, weight in weights.items()
    }
