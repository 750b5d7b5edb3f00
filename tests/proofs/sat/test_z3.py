"""z3 in place of python-sat: the real one where it is installed, and everywhere a stub with the part of its interface
that is used.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from types import SimpleNamespace

import pytest

from cspdiag.proofs.portfolio import prove_deadlock_free, prove_knot_free
from cspdiag.proofs.sat.deadlock import by_sat
from cspdiag.proofs.sat.solver import SolverTimeoutError, find_solver
from cspdiag.proofs.structure.question import StuckQuestion
from cspdiag.proofs.verdict import Limits, Proved, Refuted, Unknown
from tests.proofs.systems import known, naive
from tests.proofs.systems.random_networks import random_network, truth


@dataclass(frozen=True)
class Literal:
    """A variable of the stub, or its negation."""

    name: str
    holds: bool = True


class StubSolver:
    """Decides by trying: a variable of the shortest remaining clause gets one value, then the other."""

    def __init__(self) -> None:
        self.clauses: list[list[Literal]] = []
        self.timeout: int | None = None
        self.found: dict[str, bool] = {}

    def set(self, name: str, value: int) -> None:
        assert name == "timeout"
        self.timeout = value

    def add(self, clauses: Sequence[Sequence[Literal]]) -> None:
        self.clauses += map(list, clauses)

    def check(self, assumed: Sequence[Literal]) -> str:
        assert self.timeout is not None, "there is no time limit"
        if self.timeout <= 1:
            return "unknown"
        found = _decided([*self.clauses, *([literal] for literal in assumed)], {})
        self.found = found or {}
        return "unsat" if found is None else "sat"

    def model(self) -> StubModel:
        return StubModel(self.found)


@dataclass(frozen=True)
class StubModel:
    values: dict[str, bool]

    def __getitem__(self, variable: Literal) -> bool | None:
        return self.values.get(variable.name)


def _decided(clauses: list[list[Literal]], values: dict[str, bool]) -> dict[str, bool] | None:
    while True:
        left = []
        for clause in clauses:
            if not any(values.get(literal.name) == literal.holds for literal in clause):
                left.append([literal for literal in clause if literal.name not in values])
        if not left:
            return values
        clauses, shortest = left, min(left, key=len)
        if not shortest:
            return None
        if len(shortest) > 1:
            break
        values = {**values, shortest[0].name: shortest[0].holds}
    for value in (shortest[0].holds, not shortest[0].holds):
        found = _decided(clauses, {**values, shortest[0].name: value})
        if found is not None:
            return found
    return None


def stub() -> SimpleNamespace:
    """The part of z3 that is used."""

    def solver_for(logic: str) -> StubSolver:
        assert logic == "QF_FD"
        return StubSolver()

    return SimpleNamespace(
        SolverFor=solver_for,
        Bool=Literal,
        Not=lambda literal: Literal(literal.name, not literal.holds),
        Or=list,
        unknown="unknown",
        unsat="unsat",
        is_true=lambda value: value is True,
    )


@pytest.fixture(params=["stub", "z3"], autouse=True)
def only_z3(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """python-sat is not available."""
    monkeypatch.setitem(sys.modules, "pysat.solvers", None)
    if request.param == "stub":
        monkeypatch.setitem(sys.modules, "z3", stub())
    elif find_spec("z3") is None:
        pytest.skip("z3 is not installed")


def test_z3_is_found_without_python_sat() -> None:
    solver = find_solver()
    assert solver is not None
    assert solver.__name__ == "_Z3"


def test_assumptions_count_for_one_model_only() -> None:
    create = find_solver()
    assert create is not None
    solver = create(60.0)
    solver.add([[1, 2], [-1, 3], [-2, -3]])
    assert solver.solve([1]) == {1, 3}
    assert solver.solve([2]) == {2}
    assert solver.solve([1, 2]) is None
    solver.add([[-1]])
    assert solver.solve([]) == {2}
    solver.add([[-2]])
    assert solver.solve([]) is None
    solver.close()


def test_a_time_limit_is_reported() -> None:
    create = find_solver()
    assert create is not None
    solver = create(0.0)
    # Nine pigeons in eight holes.
    hole = {(pigeon, at): 8 * pigeon + at + 1 for pigeon in range(9) for at in range(8)}
    solver.add([[hole[pigeon, at] for at in range(8)] for pigeon in range(9)])
    solver.add([[-hole[one, at], -hole[two, at]] for two in range(9) for one in range(two) for at in range(8)])
    with pytest.raises(SolverTimeoutError):
        solver.solve([])


@pytest.mark.parametrize("together", [True, False], ids=["deadlock", "knot"])
def test_systems_known_to_be_free_are_proved(together: bool) -> None:
    for system in (known.philosophers(4, left_handed=1), known.milner(4), known.token_ring(4)):
        assert isinstance(by_sat(StuckQuestion(system, together), Limits()), Proved)


def test_a_table_is_refuted_and_a_counting_one_proved() -> None:
    refuted = prove_deadlock_free(known.philosophers(4), Limits(), ["sat"])
    assert isinstance(refuted, Refuted)
    assert naive.deadlocked(known.philosophers(4), naive.replay(known.philosophers(4), refuted.trace))
    assert isinstance(prove_knot_free(known.table_with_butler(3, 2), Limits(), ["invariants"]), Proved)


def test_random_networks_are_proved_only_if_they_are_free() -> None:
    answers = set()
    for seed in range(40):
        system = random_network(seed, components=3)
        facts = truth(system)
        assert facts is not None
        for together, fails in ((True, facts.deadlock), (False, facts.knot)):
            answer = by_sat(StuckQuestion(system, together), Limits())
            assert isinstance(answer, Unknown) or not fails, seed
            answers.add((type(answer), fails))
    assert answers >= {(Proved, False), (Unknown, True)}
