"""Invariants: what hubs and counters keep in balance is found, and used only if it holds exactly."""

from __future__ import annotations

import sys
import threading
import time

import pytest

from cspdiag.proofs.sat.deadlock import by_sat
from cspdiag.proofs.sat.invariants import prove as invariants
from cspdiag.proofs.sat.invariants.basis import invariants_with_equality
from cspdiag.proofs.sat.invariants.problem import problem_of
from cspdiag.proofs.sat.invariants.process import WeightsProcess
from cspdiag.proofs.sat.invariants.prove import by_invariants
from cspdiag.proofs.structure.pairs import Structure
from cspdiag.proofs.structure.question import StuckQuestion
from cspdiag.proofs.verdict import Limits, Proved, Unknown
from tests.proofs.systems import known, naive
from tests.proofs.systems.known import counted_meals, table_with_butler
from tests.proofs.systems.random_networks import FORMS, random_network

pytest.importorskip("pysat")


@pytest.mark.parametrize("together", [True, False], ids=["deadlock", "knot"])
def test_a_butler_that_keeps_one_seat_empty_gives_a_proof(together: bool) -> None:
    question = StuckQuestion(table_with_butler(5, 4), together)
    assert isinstance(by_sat(question, Limits()), Unknown), "pairs and traps do not count"
    verdict = by_invariants(question, Limits())
    assert isinstance(verdict, Proved)
    assert "invariant" in verdict.reason


def test_there_is_no_deadlock_next_to_a_loop_that_never_waits() -> None:
    assert isinstance(by_invariants(StuckQuestion(known.with_loop(table_with_butler(3, 3)), True), Limits()), Proved)


def test_a_butler_that_admits_all_philosophers_proves_nothing() -> None:
    verdict = by_invariants(StuckQuestion(table_with_butler(4, 4), together=True), Limits())
    assert isinstance(verdict, Unknown)
    assert verdict.candidate is not None


@pytest.mark.parametrize("together", [True, False], ids=["deadlock", "knot"])
def test_a_large_table_needs_no_more_than_the_invariants_that_hold_with_equality(
    together: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(WeightsProcess, "weights", lambda *_: pytest.fail("the solver for weights was asked"))
    for system in (table_with_butler(40, 39), counted_meals(60)):
        question = StuckQuestion(system, together)
        assert isinstance(by_sat(question, Limits()), Unknown), "pairs and traps do not count"
        assert isinstance(by_invariants(question, Limits()), Proved)


def test_invariants_with_equality_serve_where_the_system_is_too_large_for_the_solver(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(invariants, "LARGEST_PROBLEM", 10)
    monkeypatch.setattr(WeightsProcess, "weights", lambda *_: pytest.fail("the solver for weights was asked"))
    assert isinstance(by_invariants(StuckQuestion(table_with_butler(8, 7), together=True), Limits()), Proved)
    verdict = by_invariants(StuckQuestion(table_with_butler(8, 8), together=True), Limits())
    assert isinstance(verdict, Unknown)
    assert verdict.candidate is not None


def test_invariants_with_equality_hold_in_every_reachable_state() -> None:
    found = 0
    for seed in range(150):
        system = random_network(seed, form=FORMS[seed % len(FORMS)])
        states = [state for layer in naive.layers(system) for state in layer]
        structure = Structure(system)
        problem = problem_of(structure)
        for weights in invariants_with_equality(structure, Limits()):
            assert any(weights.values())
            assert problem.never_increases(weights), seed
            assert {problem.excess(weights, state) for state in states} == {0}, seed
            found += 1
    assert found > 300


def test_the_invariants_with_equality_are_all_there_are() -> None:
    # For the forks: whether a philosopher has it or not; for the butler: how many philosophers are seated.
    assert len(invariants_with_equality(Structure(known.philosophers(6)), Limits())) == 12
    assert len(invariants_with_equality(Structure(table_with_butler(6, 5)), Limits())) == 13
    # The token is somewhere: one sum for all stations. Stations that wish to work say nothing about the others.
    (weights,) = invariants_with_equality(Structure(known.token_ring(4)), Limits())
    assert sorted(weights) == [0, 1, 2, 3]


def test_weights_that_increase_somewhere_are_refused() -> None:
    problem = problem_of(Structure(known.philosophers(3)))
    assert problem.never_increases({})
    # Only a philosopher's second state has a weight: taking the step to it increases the sum.
    assert not problem.never_increases({0: {1: 1}})
    # With a minus sign, leaving the state increases it.
    assert not problem.never_increases({0: {1: -1}})


def test_a_fork_is_taken_by_the_philosopher_that_holds_it() -> None:
    system = known.philosophers(3)
    problem = problem_of(Structure(system))
    # Philosopher 0 picks fork 0 in its second step, and puts it back in its last; in between, the fork is in its state
    # 1.
    fork = next(at for at, part in enumerate(system.components) if part.name == "fork0")
    weights = {0: dict.fromkeys((2, 3, 4, 5), 1), fork: {1: -1}}
    assert problem.never_increases(weights)
    assert problem.excess(weights, [2] + [0] * (len(system.components) - 1)) == 1


def test_the_solver_is_ended_when_its_time_is_up() -> None:
    problem = problem_of(Structure(known.philosophers(3)))
    with WeightsProcess(problem, Limits(seconds=0.0)) as process:
        deadline = time.monotonic() + 20
        while process.weights([0] * len(problem.places)) is not None:
            assert time.monotonic() < deadline
        # Another request is answered with None instead of waiting.
        assert process.weights([0] * len(problem.places)) is None


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux says how much memory a process has")
def test_the_solver_has_no_more_memory_than_the_limit_says() -> None:
    structure = Structure(known.counted_meals(60, meals=1))
    problem = problem_of(structure)
    # The last philosopher has eaten, and no other process has done anything.
    candidate = [shape.initial for shape in structure.shapes]
    candidate[59] = 4
    with WeightsProcess(problem, Limits()) as process:
        assert process.weights(candidate) is not None
    with WeightsProcess(problem, Limits(memory=100_000)) as process:
        assert process.weights(candidate) is None


def test_the_time_limit_makes_the_answer_unknown() -> None:
    verdict = by_invariants(StuckQuestion(table_with_butler(5, 4), together=True), Limits(seconds=0.0))
    assert isinstance(verdict, Unknown)


def test_no_solver_starts_a_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    # The alarm of the time limit may cut off what starts it, which would leave the thread behind.
    monkeypatch.setattr(threading.Thread, "start", lambda _: pytest.fail("a thread was started"))
    assert isinstance(by_sat(StuckQuestion(table_with_butler(5, 4), together=True), Limits()), Unknown)
    problem = problem_of(Structure(known.philosophers(3)))
    with WeightsProcess(problem, Limits()) as process:
        process.weights([0] * len(problem.places))
