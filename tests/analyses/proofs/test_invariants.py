"""Invariants: what hubs and counters keep in balance is found, and used only if it holds exactly."""

from __future__ import annotations

import time

import pytest

from cspdiag.analyses.proofs.invariants import by_invariants
from cspdiag.analyses.proofs.invariants_problem import problem_of
from cspdiag.analyses.proofs.invariants_process import WeightsProcess
from cspdiag.analyses.proofs.pairs import Structure
from cspdiag.analyses.proofs.question import Question
from cspdiag.analyses.proofs.sat import by_sat
from cspdiag.analyses.proofs.verdict import Limits, Proved, Unknown
from cspdiag.analyses.transitions.system import System
from tests.analyses.proofs import known
from tests.analyses.proofs.known import Machine, compose, cycle

pytest.importorskip("pysat")


def table_with_butler(seats: int, admitted: int) -> System:
    """Philosophers of one hand; a butler lets so many of them sit down at once."""
    machines = []
    for at in range(seats):
        left, right = f"{at}.{at}", f"{at}.{(at + 1) % seats}"
        machines.append(
            cycle(
                f"philosopher{at}", f"sit{at}", f"pick{left}", f"pick{right}", f"put{left}", f"put{right}", f"rise{at}"
            )
        )
    for at in range(seats):
        one, other = f"{at}.{at}", f"{(at - 1) % seats}.{at}"
        table = {
            "free": [(f"pick{one}", "one"), (f"pick{other}", "other")],
            "one": [(f"put{one}", "free")],
            "other": [(f"put{other}", "free")],
        }
        machines.append(Machine(f"fork{at}", table))
    butler: dict[str, list[tuple[str, str]]] = {}
    for seated in range(admitted + 1):
        comes = [(f"sit{at}", f"{seated + 1}") for at in range(seats)] if seated < admitted else []
        goes = [(f"rise{at}", f"{seated - 1}") for at in range(seats)] if seated else []
        butler[f"{seated}"] = comes + goes
    return compose([*machines, Machine("butler", butler)])


@pytest.mark.parametrize("together", [True, False], ids=["deadlock", "knot"])
def test_a_butler_who_keeps_one_seat_empty_is_understood(together: bool) -> None:
    question = Question(table_with_butler(5, 4), together)
    assert isinstance(by_sat(question, Limits()), Unknown), "pairs and traps do not count"
    verdict = by_invariants(question, Limits())
    assert isinstance(verdict, Proved)
    assert "invariant" in verdict.reason


def test_a_butler_who_admits_everybody_proves_nothing() -> None:
    verdict = by_invariants(Question(table_with_butler(4, 4), together=True), Limits())
    assert isinstance(verdict, Unknown)
    assert verdict.candidate is not None


def test_weights_that_increase_somewhere_are_refused() -> None:
    problem = problem_of(Structure(known.philosophers(3)))
    assert problem.never_increases([{} for _ in problem.places])
    # Only a philosopher's second state weighs something: taking the step to it increases the sum.
    weights: list[dict[int, int]] = [{} for _ in problem.places]
    weights[0] = {1: 1}
    assert not problem.never_increases(weights)
    # With a minus sign, leaving it does.
    weights[0] = {1: -1}
    assert not problem.never_increases(weights)


def test_a_fork_is_taken_by_whom_holds_it() -> None:
    system = known.philosophers(3)
    problem = problem_of(Structure(system))
    # Philosopher 0 picks fork 0 in its second step, and puts it back in its last; the fork is then in its state 1.
    weights: list[dict[int, int]] = [{} for _ in problem.places]
    fork = next(at for at, part in enumerate(system.components) if part.name == "fork0")
    weights[0] = dict.fromkeys((2, 3, 4, 5), 1)
    weights[fork] = {1: -1}
    assert problem.never_increases(weights)
    assert problem.excess(weights, [2] + [0] * (len(system.components) - 1)) == 1


def test_the_solver_is_ended_when_its_time_is_up() -> None:
    problem = problem_of(Structure(known.philosophers(3)))
    with WeightsProcess(problem, seconds=0.0) as process:
        deadline = time.monotonic() + 20
        while process.weights([0] * len(problem.places)) is not None:
            assert time.monotonic() < deadline
        # Whoever asks again is told that there is nothing, not left waiting.
        assert process.weights([0] * len(problem.places)) is None


def test_the_time_limit_makes_the_answer_unknown() -> None:
    verdict = by_invariants(Question(table_with_butler(5, 4), together=True), Limits(seconds=0.0))
    assert isinstance(verdict, Unknown)
