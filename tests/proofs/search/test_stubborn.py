"""Stubborn sets settle in a few states what all interleavings together would not."""

from __future__ import annotations

import pytest

from cspdiag.base.record import replaced
from cspdiag.proofs.search import stubborn
from cspdiag.proofs.search.stuck_sets import OffersByState
from cspdiag.proofs.transitions.systems.system import INTERNAL, Component, System
from cspdiag.proofs.verdict import Limits, Proved, Refuted, Unknown
from tests.proofs.systems import known
from tests.proofs.systems.naive import deadlocked, replay

FREE = {
    "20 asymmetric philosophers": (known.philosophers(20, left_handed=1), 2000),
    "Milner's scheduler 100": (known.milner(100), 1000),
    "token ring 50": (known.token_ring(50), 500),
    "I/O-PAR ring 50": (known.io_par_ring(50), 2000),
    "alternating bit, lossy": (known.alternating_bit(), 116),
    "client-server chain 50": (known.client_server_chain(50), 200),
    "controller of 4 joints": (known.controller(4), 30_000),
}
DEADLOCKED = {
    "20 philosophers": known.philosophers(20),
    "I/O-SEQ ring 4": known.io_seq_ring(4),
    "alternating bit, time-out on reliable media": known.alternating_bit(lossy=False),
    "client-server ring 7": known.client_server_ring(7),
    "controller of 3 joints that commit": known.controller(3, commits=True),
}


@pytest.mark.parametrize("name", FREE)
@pytest.mark.parametrize("search", [stubborn.deadlock_free, stubborn.knot_free])
def test_a_few_states_represent_all(name: str, search: type) -> None:
    system, most = FREE[name]
    verdict = search(system, Limits())
    assert isinstance(verdict, Proved)
    assert verdict.states is not None
    assert 0 < verdict.states <= most


@pytest.mark.parametrize("name", DEADLOCKED)
def test_a_deadlock_is_found_with_a_trace_to_it(name: str) -> None:
    system = DEADLOCKED[name]
    verdict = stubborn.deadlock_free(system, Limits())
    assert isinstance(verdict, Refuted)
    assert deadlocked(system, replay(system, verdict.trace))


@pytest.mark.parametrize("name", DEADLOCKED)
def test_a_knot_is_found_next_to_a_loop_and_its_trace_has_no_move_of_the_loop(name: str) -> None:
    system = known.with_loop(DEADLOCKED[name])
    assert isinstance(stubborn.deadlock_free(system, Limits()), Proved)
    verdict = stubborn.knot_free(system, Limits())
    assert isinstance(verdict, Refuted)
    assert OffersByState(system).knot(replay(system, verdict.trace)) == verdict.stuck
    loop = {len(system.components) - 2, len(system.components) - 1}
    assert loop.isdisjoint(party for move in verdict.trace for party, _ in move.moves)


def test_an_event_that_a_loop_would_delay_forever_is_followed() -> None:
    """A process that spins is the smallest choice in every state, while two others start to wait for each other."""
    spinner = Component("spinner", (((INTERNAL, 0),),))
    ring = known.compose([known.cycle("one", "begin", "a", "b"), known.cycle("other", "b", "a")])
    system = System((spinner, *ring.components), tuple(
        type(event)(event.channel, tuple(party + 1 for party in event.parties), event.kind) for event in ring.events
    ))  # fmt: skip
    verdict = stubborn.knot_free(system, Limits())
    assert isinstance(verdict, Refuted)
    assert verdict.stuck == (1, 2)
    assert len(verdict.trace) == 1


def test_a_search_that_reaches_a_limit_says_so() -> None:
    verdict = stubborn.deadlock_free(known.controller(5), Limits(seconds=0.0))
    assert isinstance(verdict, Unknown)
    assert "time limit" in verdict.reason
    verdict = stubborn.knot_free(known.controller(5), Limits(memory=1_000_000))
    assert isinstance(verdict, Unknown)
    assert "memory limit" in verdict.reason


def test_where_a_failure_may_end_what_is_stuck_the_question_is_left_open() -> None:
    ring = known.with_loop(known.philosophers(4))
    failing = replaced(ring, events=(*ring.events[:-1], replaced(ring.events[-1], kind="failure")))
    verdict = stubborn.knot_free(failing, Limits())
    assert isinstance(verdict, Unknown)
    assert "a missed sample or a fault" in verdict.reason
