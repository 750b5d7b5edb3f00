"""The methods together: the first that knows the answer gives it, and refutations come with a trace that can be
followed.
"""

from __future__ import annotations

from itertools import count
from types import SimpleNamespace

import pytest

from cspdiag.proofs import portfolio, verdict
from cspdiag.proofs.portfolio import METHODS, prove_deadlock_free, prove_knot_free
from cspdiag.proofs.sat import solver as sat_solver
from cspdiag.proofs.structure.pairs import Structure
from cspdiag.proofs.transitions.systems.system import System
from cspdiag.proofs.verdict import LimitError, Limits, Method, Proved, Refuted, Unknown
from tests.proofs.systems import known, naive
from tests.proofs.systems.random_networks import FORMS, plain_knot, random_network, truth
from tests.proofs.systems.random_systems import random_system


@pytest.mark.parametrize("number", [4, 6, 8])
def test_philosophers_are_refuted_by_a_shortest_trace(number: int) -> None:
    # Without the two events in which only philosophers take part, the known lengths are 8, 12, 16 as well.
    system = known.philosophers(number)
    verdict = prove_deadlock_free(system, Limits())
    assert isinstance(verdict, Refuted)
    assert len(verdict.trace) == 2 * number
    assert naive.deadlocked(system, naive.replay(system, verdict.trace))


def test_a_thousand_philosophers_are_refuted_too() -> None:
    system = known.philosophers(1000)
    for prove in (prove_deadlock_free, prove_knot_free):
        verdict = prove(system, Limits())
        assert isinstance(verdict, Refuted)
        assert len(verdict.trace) == 2000
        assert len(verdict.stuck) == 2000


@pytest.mark.parametrize(
    ("system", "steps"),
    [(known.counted_meals(60, one_left_handed=False), 60), (known.table_with_butler(60, 60), 120)],
    ids=["meals are counted", "a butler admits one too many"],
)
def test_large_tables_with_counters_are_refuted_by_a_shortest_trace(system: System, steps: int) -> None:
    for prove in (prove_deadlock_free, prove_knot_free):
        verdict = prove(system, Limits())
        assert isinstance(verdict, Refuted)
        assert len(verdict.trace) == steps
        assert naive.deadlocked(system, naive.replay(system, verdict.trace))


def test_the_knot_next_to_a_loop_is_found_and_reported_whole() -> None:
    system = known.with_loop(known.philosophers(6))
    assert isinstance(prove_deadlock_free(system, Limits()), Proved)
    verdict = prove_knot_free(system, Limits())
    assert isinstance(verdict, Refuted)
    assert verdict.stuck == tuple(range(12))


def test_a_controller_of_four_joints_is_proved_without_search_and_a_hasty_one_refuted() -> None:
    for prove in (prove_deadlock_free, prove_knot_free):
        assert prove(known.controller(4), Limits()).method == "rules"
        assert isinstance(prove(known.controller(2, commits=True), Limits()), Refuted)


@pytest.mark.parametrize("method", METHODS)
def test_a_method_can_be_used_alone(method: Method) -> None:
    for prove in (prove_deadlock_free, prove_knot_free):
        assert prove(known.milner(3), Limits(), [method]).method == method


@pytest.mark.parametrize("form", [*FORMS, "plain"])
def test_random_networks_get_the_right_answer_and_a_trace_that_can_be_followed(form: str) -> None:
    for seed in range(2000, 2060):
        system = random_system(seed) if form == "plain" else random_network(seed, form=form)  # type: ignore[arg-type]
        facts = truth(system)
        assert facts is not None
        for prove, fails, is_stuck in (
            (prove_deadlock_free, facts.deadlock, naive.deadlocked),
            (prove_knot_free, facts.knot, plain_knot),
        ):
            verdict = prove(system, Limits())
            assert isinstance(verdict, Refuted if fails else Proved), seed
            if isinstance(verdict, Refuted):
                assert is_stuck(system, naive.replay(system, verdict.trace)), seed


def test_without_a_solver_the_searches_answer_and_say_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sat_solver, "_SOLVERS", ())
    verdict = prove_deadlock_free(known.token_ring(4), Limits())
    assert isinstance(verdict, Proved)
    assert verdict.method == "stubborn"
    assert verdict.reason.endswith("no SAT solver is installed (pip install 'cspdiag[verify]')")
    assert isinstance(prove_knot_free(known.philosophers(4), Limits()), Refuted)


def test_a_reason_that_several_methods_have_is_said_once() -> None:
    unknown = [Unknown("sat", "no solver"), Unknown("stubborn", "too many states"), Unknown("invariants", "no solver")]
    assert portfolio._together(unknown).reason == "sat, invariants: no solver; stubborn: too many states"


def test_what_no_method_settles_in_time_is_unknown_with_the_reasons_and_the_candidate() -> None:
    verdict = prove_deadlock_free(known.client_server_ring(9), Limits(), ["rules"])
    assert isinstance(verdict, Unknown)
    assert verdict.reason.startswith("rules: `p0` has an alternative")
    assert isinstance(prove_knot_free(known.milner(3), Limits(seconds=0.0), ["sat", "breadth-first"]), Unknown)


@pytest.mark.parametrize("together", [True, False], ids=["deadlock", "knot"])
@pytest.mark.parametrize("method", METHODS)
def test_every_method_looks_at_the_clock_again_and_again(
    method: Method, together: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("pysat")
    # Every check of the time takes a second.
    clock = SimpleNamespace(monotonic=count().__next__)
    monkeypatch.setattr(verdict, "time", clock)
    prove = prove_deadlock_free if together else prove_knot_free
    answer = prove(known.table_with_butler(20, 19), Limits(seconds=30.0), [method])
    assert isinstance(answer, Unknown)
    assert "the time limit" in answer.reason


def test_the_analysis_of_pairs_takes_bounded_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(verdict, "time", SimpleNamespace(monotonic=count().__next__))
    with pytest.raises(LimitError):
        _ = Structure(known.table_with_butler(20, 19), Limits(seconds=1000.0)).neighbours
