"""Events that only one party distinguishes count as one, and that changes nothing else."""

from __future__ import annotations

import pytest

from cspdiag.base.record import replaced
from cspdiag.proofs.portfolio import prove_deadlock_free, prove_knot_free
from cspdiag.proofs.rules.runs import moves_of, only_run
from cspdiag.proofs.structure.merging import representatives
from cspdiag.proofs.structure.pairs import Structure
from cspdiag.proofs.transitions.systems.system import Edge, System
from cspdiag.proofs.verdict import Limits, Proved, Refuted
from tests.proofs.systems import known, naive
from tests.proofs.systems.random_networks import FORMS, plain_knot, random_network, truth


def split(system: System) -> System:
    """The system with two events for each one of two or more parties: the first party takes one in even states, the
    other in odd ones.
    """
    count = len(system.events)
    components = []
    for index, component in enumerate(system.components):
        states = []
        for state, edges in enumerate(component.edges):
            doubled: list[Edge] = []
            for event, after in edges:
                parties = system.events[event].parties if event >= 0 else ()
                if len(parties) < 2:
                    doubled.append((event, after))
                elif parties[0] == index:
                    doubled.append((event + count * (state % 2), after))
                else:
                    doubled += [(event, after), (event + count, after)]
            states.append(tuple(doubled))
        components.append(replaced(component, edges=tuple(states)))
    return System(tuple(components), system.events * 2)


def test_split_events_are_merged_again() -> None:
    system = known.philosophers(3)
    merged = representatives(split(system))
    for number, event in enumerate(system.events):
        if len(event.parties) > 1:
            assert merged[number + len(system.events)] == number


def test_events_that_two_parties_distinguish_stay_two() -> None:
    system = known.client_server_ring(3)
    assert representatives(system) == list(range(len(system.events)))


@pytest.mark.parametrize("form", FORMS)
def test_a_system_and_its_split_one_get_the_same_answers(form: str) -> None:
    for seed in range(3000, 3030):
        system = split(random_network(seed, form=form))  # type: ignore[arg-type]
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


def test_the_run_of_a_split_system_can_be_followed() -> None:
    system = split(known.milner(4))
    structure = Structure(system)
    run = only_run(structure, Limits(), 10_000)
    assert run is not None
    assert naive.replay(system, moves_of(structure, run)) == run.state
