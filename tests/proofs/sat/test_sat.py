"""Proofs by SAT: they agree with exploring every state, and settle what no search could."""

from __future__ import annotations

import pytest

from cspdiag.proofs.sat import solver as sat_solver
from cspdiag.proofs.sat.deadlock import by_sat
from cspdiag.proofs.structure.question import StuckQuestion
from cspdiag.proofs.transitions.systems.system import System
from cspdiag.proofs.verdict import Limits, Proved, Unknown
from tests.proofs.systems import known
from tests.proofs.systems.random_networks import FORMS, Form, random_network, truth

pytest.importorskip("pysat")


def proof(system: System, *, together: bool) -> Proved | Unknown:
    return by_sat(StuckQuestion(system, together), Limits())


@pytest.mark.parametrize("together", [True, False], ids=["deadlock", "knot"])
@pytest.mark.parametrize(
    "system",
    [
        known.philosophers(5, left_handed=1),
        known.milner(5),
        known.token_ring(5),
        known.io_par_ring(6),
        known.client_server_chain(6),
        known.alternating_bit(),
    ],
    ids=["philosophers", "Milner", "token ring", "I/O-PAR", "client-server", "alternating bit"],
)
def test_systems_known_to_be_free_are_proved(system: System, together: bool) -> None:
    assert isinstance(proof(system, together=together), Proved)


@pytest.mark.parametrize("together", [True, False], ids=["deadlock", "knot"])
def test_the_candidate_of_the_philosophers_is_their_deadlock(together: bool) -> None:
    system = known.philosophers(4)
    verdict = proof(system, together=together)
    assert isinstance(verdict, Unknown)
    assert verdict.candidate is not None
    # Every philosopher has one fork, all on the same side, and every fork is taken.
    assert len({verdict.candidate[at] for at in range(4)}) == 1
    assert system.components[4].initial not in verdict.candidate[4:]
    assert verdict.stuck == tuple(range(8))


def test_a_loop_hides_the_deadlock_of_the_philosophers_but_not_their_knot() -> None:
    system = known.with_loop(known.philosophers(4))
    assert isinstance(proof(system, together=True), Proved)
    verdict = proof(system, together=False)
    assert isinstance(verdict, Unknown)
    assert verdict.stuck == tuple(range(8))


@pytest.mark.parametrize("together", [True, False], ids=["deadlock", "knot"])
def test_a_thousand_processes_are_proved(together: bool) -> None:
    for system in (known.philosophers(1000, left_handed=1), known.milner(1000)):
        assert isinstance(proof(system, together=together), Proved)


@pytest.mark.parametrize("form", FORMS)
def test_random_networks_are_proved_only_if_free_and_nearly_always_then(form: Form) -> None:
    proved = {True: 0, False: 0}
    free = {True: 0, False: 0}
    for seed in range(120):
        system = random_network(seed, form=form)
        facts = truth(system)
        assert facts is not None
        for together, fails in ((True, facts.deadlock), (False, facts.knot)):
            answer = proof(system, together=together)
            assert not (isinstance(answer, Proved) and fails), seed
            free[together] += not fails
            proved[together] += isinstance(answer, Proved)
    for together in (True, False):
        assert 20 < free[together] < 120
        assert proved[together] >= 0.95 * free[together]


def test_without_a_solver_the_answer_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sat_solver, "_SOLVERS", ())
    verdict = proof(known.milner(3), together=True)
    assert isinstance(verdict, Unknown)
    assert "cspdiag[verify]" in verdict.reason


def test_the_time_limit_is_kept() -> None:
    verdict = by_sat(StuckQuestion(known.milner(200), False), Limits(seconds=0.0))
    assert isinstance(verdict, Unknown)
    assert "time limit" in verdict.reason
