"""Breadth-first search finds the known numbers of states and deadlocks, and the shortest traces."""

from __future__ import annotations

from math import comb

import pytest

from cspdiag.proofs.search.breadth_first import count, deadlock_free, explore, knot_free
from cspdiag.proofs.search.packing import Flags, Packing, Words
from cspdiag.proofs.transitions.systems.system import INTERNAL, Component, System
from cspdiag.proofs.verdict import Limits, Proved, Refuted, Unknown
from tests.proofs.systems import known
from tests.proofs.systems.naive import replay

FREE = {
    "asymmetric philosophers 4": (known.philosophers(4, left_handed=1), 464),
    "asymmetric philosophers 5": (known.philosophers(5, left_handed=1), 2240),
    "asymmetric philosophers 6": (known.philosophers(6, left_handed=1), 10816),
    "asymmetric philosophers 7": (known.philosophers(7, left_handed=1), 52224),
    "asymmetric philosophers 8": (known.philosophers(8, left_handed=1), 252160),
    "Milner's scheduler 5": (known.milner(5), 3 * 5 * 2**4),
    "Milner's scheduler 9": (known.milner(9), 3 * 9 * 2**8),
    "token ring 4": (known.token_ring(4), 4 * 2**5),
    "token ring 9": (known.token_ring(9), 9 * 2**10),
    "I/O-PAR ring 4": (known.io_par_ring(4), 70),
    "I/O-PAR ring 8": (known.io_par_ring(8), 12870),
    "alternating bit, lossy": (known.alternating_bit(), 116),
    "client-server chain 4": (known.client_server_chain(4), 7),
    "client-server chain 8": (known.client_server_chain(8), 15),
    "controller of 1 joint": (known.controller(1), 1632),
}
DEADLOCKED = {
    "philosophers 4": (known.philosophers(4), 543, 1, 8),
    "philosophers 5": (known.philosophers(5), 2623, 1, 10),
    "philosophers 6": (known.philosophers(6), 12671, 1, 12),
    "philosophers 7": (known.philosophers(7), 61183, 1, 14),
    "philosophers 8": (known.philosophers(8), 295423, 1, 16),
    "I/O-SEQ ring 4": (known.io_seq_ring(4), 1, 1, 0),
    "alternating bit, time-out on reliable media": (known.alternating_bit(lossy=False), 92, 6, 11),
    "client-server ring 3": (known.client_server_ring(3), 17, 7, 3),
    "client-server ring 5": (known.client_server_ring(5), 122, 31, 5),
    "controller of 1 joint that commits": (known.controller(1, commits=True), 1632, 1, 33),
}


@pytest.mark.parametrize("name", FREE)
def test_all_states_of_a_system_without_deadlock_are_counted(name: str) -> None:
    system, states = FREE[name]
    assert count(system, Limits()) == (states, 0)
    verdict = deadlock_free(system, Limits())
    assert isinstance(verdict, Proved)
    assert verdict.states == states
    assert isinstance(knot_free(system, Limits()), Proved)


@pytest.mark.parametrize("name", DEADLOCKED)
def test_deadlocks_are_counted_and_the_shortest_trace_leads_to_one(name: str) -> None:
    system, states, deadlocks, length = DEADLOCKED[name]
    assert count(system, Limits()) == (states, deadlocks)
    verdict = deadlock_free(system, Limits())
    assert isinstance(verdict, Refuted)
    assert len(verdict.trace) == length
    last = replay(system, verdict.trace)
    assert set(verdict.stuck) == {
        at for at, component in enumerate(system.components) if component.process and last[at] not in component.terminal
    }


def test_a_loop_that_runs_on_hides_a_deadlock_but_not_a_knot() -> None:
    system = known.with_loop(known.philosophers(6))
    assert count(system, Limits()) == (25342, 0)
    assert isinstance(deadlock_free(system, Limits()), Proved)
    verdict = knot_free(system, Limits())
    assert isinstance(verdict, Refuted)
    assert len(verdict.trace) == 12
    assert verdict.stuck == tuple(range(12))
    replay(system, verdict.trace)


@pytest.mark.parametrize("search", [deadlock_free, knot_free])
def test_a_search_that_reaches_a_limit_says_so(search: type) -> None:
    system: System = known.philosophers(8, left_handed=1)
    no_time = search(system, Limits(seconds=0.0))
    assert isinstance(no_time, Unknown)
    assert "time limit" in no_time.reason
    no_memory = search(system, Limits(memory=200_000))
    assert isinstance(no_memory, Unknown)
    assert "memory limit" in no_memory.reason


def test_states_of_more_than_one_word_are_distinguished() -> None:
    packing = Packing(known.io_par_ring(34))
    assert packing.words == 2
    sizes: list[int] = []

    def until_the_fourth_layer(words: Words, can_step: Flags) -> Flags | None:
        sizes.append(len(can_step))
        return can_step if len(sizes) == 4 else None

    explore(packing, Limits(), until_the_fourth_layer)
    assert sizes == [1, comb(34, 1), comb(34, 2), comb(34, 3) + 34], (
        "channels that communicated, or a node that computed"
    )


def test_a_component_with_many_internal_steps_takes_them_as_one() -> None:
    count_of = 2000
    chain = Component("chain", tuple(((INTERNAL, (state + 1) % count_of),) for state in range(count_of)))
    system = System((chain, chain), ())
    assert len(Packing(system).steps) == 2
    assert deadlock_free(System((chain,), ()), Limits()) == Proved(
        "breadth-first", "none of the 2000 reachable states is deadlocked", count_of
    )
