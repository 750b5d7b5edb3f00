"""Compositional minimization proves large networks with few states at a time, and never loses a livelock or a
deadlock.
"""

from __future__ import annotations

import pytest

from cspdiag.base.record import replaced
from cspdiag.proofs.reduce import minimization, parallel_machines
from cspdiag.proofs.reduce.branching_bisimulation import Machine, minimized
from cspdiag.proofs.reduce.parallel_machines import Pairs, part_of, with_divergent_states_merged
from cspdiag.proofs.transitions.systems.system import INTERNAL, System
from cspdiag.proofs.verdict import Limits, Proved, Refuted, Unknown
from tests.proofs.systems import known, naive

FREE = {
    "100 asymmetric philosophers": (known.philosophers(100, left_handed=1), 20),
    "Milner's scheduler 50": (known.milner(50), 100),
    "token ring 50": (known.token_ring(50), 100),
    "I/O-PAR ring 50": (known.io_par_ring(50), 200),
    "alternating bit, lossy": (known.alternating_bit(), 116),
    "client-server chain 50": (known.client_server_chain(50), 10),
    "controller of 4 joints": (known.controller(4), 100),
    "two systems that have nothing in common": (known.with_loop(known.philosophers(8)), 100),
}
DEADLOCKED = {
    "8 philosophers": known.philosophers(8),
    "I/O-SEQ ring 4": known.io_seq_ring(4),
    "alternating bit, time-out on reliable media": known.alternating_bit(lossy=False),
    "client-server ring 5": known.client_server_ring(5),
    "controller of 2 joints that commit": known.controller(2, commits=True),
}


@pytest.mark.parametrize("name", FREE)
def test_a_network_without_deadlock_is_proved_with_small_machines(name: str) -> None:
    system, most = FREE[name]
    verdict = minimization.deadlock_free(system, Limits())
    assert isinstance(verdict, Proved)
    assert verdict.method == "minimization"
    assert verdict.states is not None
    assert 1 <= verdict.states <= most


@pytest.mark.parametrize("name", DEADLOCKED)
def test_a_deadlock_is_seen_and_a_trace_to_it_searched(name: str) -> None:
    system = DEADLOCKED[name]
    verdict = minimization.deadlock_free(system, Limits())
    assert isinstance(verdict, Refuted)
    assert naive.deadlocked(system, naive.replay(system, verdict.trace))


def test_internal_steps_that_decide_nothing_vanish() -> None:
    """a ; internal ; internal ; b has three states, and the branch that only delays none of its own."""
    machine = Machine(
        (((0, 1),), ((INTERNAL, 2), (INTERNAL, 3)), ((INTERNAL, 3),), ((1, 4),), ()), (False,) * 4 + (True,)
    )
    assert minimized(machine) == Machine((((0, 1),), ((1, 2),), ()), (False, False, True))


def test_an_internal_step_that_decides_stays() -> None:
    machine = Machine((((0, 1), (INTERNAL, 2)), (), ((1, 1),)), (False, True, False))
    assert minimized(machine) == Machine((((INTERNAL, 1), (0, 2)), ((1, 2),), ()), (False, False, True))


def test_a_cycle_of_internal_steps_is_not_a_state_that_stands_still() -> None:
    turning = Machine((((0, 1),), ((INTERNAL, 2),), ((INTERNAL, 1),)), (False, False, False))
    assert minimized(turning) == Machine((((0, 1),), ((INTERNAL, 1),)), (False, False))
    standing = Machine((((0, 1),), ()), (False, False))
    assert minimized(standing) == standing


def test_a_chain_of_places_is_a_counter() -> None:
    system = known.compose(known.cycle(f"place{at}", f"pass{at}", f"pass{at + 1}") for at in range(7))
    shared = replaced(system, events=tuple(
        replaced(event, parties=(*event.parties, 99)) if event.channel in ("pass0", "pass7") else event
        for event in system.events
    ))  # fmt: skip
    pairs = Pairs(Limits())
    parts = [
        part_of(component, {event for edges in component.edges for event, _ in edges}, ())
        for component in shared.components
    ]
    whole = parts[0]
    for at, part in enumerate(parts[1:], 1):
        whole = pairs.together(
            whole, part, {event for event, known in enumerate(shared.events) if known.channel == f"pass{at}"}
        )
    assert len(whole.machine.edges) == 8


def test_identical_pairs_are_made_once(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[int] = []
    product = parallel_machines._product

    def counted(*given: object) -> Machine:
        made.append(1)
        return product(*given)  # type: ignore[arg-type]

    monkeypatch.setattr(parallel_machines, "_product", counted)
    assert isinstance(minimization.deadlock_free(known.philosophers(512, left_handed=1), Limits()), Proved)
    assert len(made) < 60, "1024 components are put together in 1023 pairs"


def test_a_limit_leaves_the_question_open(monkeypatch: pytest.MonkeyPatch) -> None:
    verdict = minimization.deadlock_free(known.philosophers(50), Limits(seconds=0.0))
    assert isinstance(verdict, Unknown)
    assert "time limit" in verdict.reason
    monkeypatch.setattr(parallel_machines, "MOST_STATES", 100)
    monkeypatch.setattr(minimization, "MOST_STATES", 100)
    verdict = minimization.deadlock_free(known.token_ring(600), Limits())
    assert isinstance(verdict, Unknown)
    assert "at most 100 states together" in verdict.reason


@pytest.mark.parametrize(
    "system",
    [
        known.alternating_bit(),
        known.client_server_chain(6),
        known.controller(1),
        known.philosophers(3, left_handed=1),
        known.io_par_ring(3),
    ],
)
def test_knots_are_excluded_as_deadlocks_of_processes_that_may_stop(system: System) -> None:
    verdict = minimization.knot_free(known.with_loop(system), Limits())
    assert isinstance(verdict, Proved)
    assert verdict.method == "minimization"


def test_a_knot_next_to_a_loop_is_seen_and_a_trace_to_it_searched() -> None:
    system = known.with_loop(known.philosophers(3))
    assert isinstance(minimization.deadlock_free(system, Limits()), Proved)
    verdict = minimization.knot_free(system, Limits())
    assert isinstance(verdict, Refuted)
    assert verdict.stuck == tuple(range(6))
    assert naive.knotted(system, naive.replay(system, verdict.trace))


def test_unstable_states_are_merged() -> None:
    turns = ((INTERNAL, 3),)
    machine = Machine((((0, 1), (1, 2)), ((INTERNAL, 3), (0, 3)), ((INTERNAL, 3), (0, 4)), turns, ()), (False,) * 5)
    assert with_divergent_states_merged(machine) == Machine(
        (((0, 3), (1, 1)), ((INTERNAL, 3), (0, 2)), (), ((INTERNAL, 3),)), (False,) * 4
    )
