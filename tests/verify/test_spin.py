"""SPIN and the exporters agree with the proofs: verdicts, numbers of states, and possible events."""

from __future__ import annotations

import re
import shutil

import pytest

from cspdiag.codegen.cspm.package import cspm
from cspdiag.codegen.promela.package import commands, numbers_of_commands, promela
from cspdiag.codegen.shared.target_error import TargetError
from cspdiag.proofs.search.breadth_first import count
from cspdiag.proofs.transitions.systems.dump import dump
from cspdiag.proofs.transitions.systems.system import INTERNAL, Component, Event, System
from cspdiag.proofs.verdict import Limits, Proved, Refuted, Unknown
from cspdiag.verify.spin import SpinError, deadlock_free
from tests.proofs.systems import known, naive
from tests.proofs.systems.random_systems import random_system

needs_spin = pytest.mark.skipif(
    shutil.which("spin") is None or shutil.which("gcc") is None, reason="spin or gcc is not installed"
)

ENDLESS = {
    "asymmetric philosophers 4": known.philosophers(4, left_handed=1),
    "alternating bit, lossy": known.alternating_bit(),
}
DEADLOCKED = {
    "philosophers 4": known.philosophers(4),
    "client-server ring 3": known.client_server_ring(3),
}


@needs_spin
@pytest.mark.parametrize("name", ENDLESS)
def test_spin_stores_exactly_the_states_of_the_system(name: str) -> None:
    system = ENDLESS[name]
    verdict = deadlock_free(system, Limits())
    assert isinstance(verdict, Proved)
    assert (verdict.states, 0) == count(system, Limits())


@needs_spin
@pytest.mark.parametrize("name", ["philosophers 4"])
def test_the_trail_of_spin_leads_to_a_deadlock(name: str) -> None:
    system = DEADLOCKED[name]
    verdict = deadlock_free(system, Limits())
    assert isinstance(verdict, Refuted)
    assert verdict.trace
    assert naive.deadlocked(system, naive.replay(system, verdict.trace))


@needs_spin
def test_spin_and_the_search_agree_on_random_systems() -> None:
    """One system without a deadlock, and one with a deadlock: both are random, but the same every time."""
    answers = {deadlocks > 0: seed for seed in range(40) for _, deadlocks in [count(random_system(seed), Limits())]}
    assert isinstance(deadlock_free(random_system(answers[False]), Limits()), Proved)
    assert isinstance(deadlock_free(random_system(answers[True]), Limits()), Refuted)


@needs_spin
def test_a_time_limit_of_spin_leaves_the_answer_unknown() -> None:
    verdict = deadlock_free(known.philosophers(8, left_handed=1), Limits(seconds=0.01))
    assert isinstance(verdict, Unknown)
    assert "time limit" in verdict.reason


@pytest.mark.parametrize("name", [*ENDLESS, *DEADLOCKED])
def test_the_commands_of_promela_are_all_that_can_happen(name: str) -> None:
    system = {**ENDLESS, **DEADLOCKED}[name]
    text = promela(system)
    assert text.count("d_step {") == len(commands(system)) == len(set(commands(system)))
    for event, moves in commands(system):
        for component, before, after in moves:
            assert (event, after) in system.components[component].edges[before]
        if event != INTERNAL:
            assert tuple(sorted(system.events[event].parties)) == tuple(component for component, _, _ in moves)


@pytest.mark.parametrize("seed", range(10))
def test_the_script_for_fdr_says_what_the_system_does(seed: int) -> None:
    """Parses the script again: its processes are the states of the components, with the same edges."""
    system = random_system(seed)
    text = cspm(system)
    assert _edges(text, system) == sum(len(edges) for component in system.components for edges in component.edges)
    parties = re.findall(r"^alphabet\((\d+)\) = \{(.*)\}$", text, re.MULTILINE)
    joined = [name for _, names in parties for name in names.split(", ") if name.startswith("e_")]
    assert len(joined) == sum(len(event.parties) for event in system.events)
    processes = sum(component.process for component in system.components)
    assert sum("ended" in names.split(", ") for _, names in parties) == processes
    assert ":[deadlock free [F]]" in text
    assert ":[divergence free]" in text


def _edges(text: str, system: System) -> int:
    """How many prefixes there are, each to a process that is defined."""
    defined = set(re.findall(r"^(P_\w+) = ", text, re.MULTILINE))
    prefixes = re.findall(r"(\w+) -> (P_\w+)", text)
    assert {after for _, after in prefixes} <= defined
    assert len(defined) == sum(len(component.edges) for component in system.components)
    return sum(event != "ended" for event, _ in prefixes)


def gathering(parties: int, states: int) -> System:
    """Components that can repeat by themselves, and can all meet in any state."""
    edges = tuple(((0, 0), (INTERNAL, (state + 1) % states)) for state in range(states))
    components = tuple(Component(f"p{number}", edges) for number in range(parties))
    return System(components, (Event("meet", tuple(range(parties))),))


@pytest.mark.parametrize("system", [gathering(3, 4), known.philosophers(4), *map(random_system, range(20))])
def test_commands_are_counted_before_they_are_made(system: System) -> None:
    assert sum(numbers_of_commands(system).values()) == len(commands(system))


def test_too_large_models_are_refused_with_their_size() -> None:
    """Only if parties meet in any state does a model grow faster than its components, and one in CSPm does not."""
    system = gathering(10, 4)
    with pytest.raises(TargetError, match=r"1,048,616 commands, 1,048,576 of them for `meet`.* its 10 parties"):
        promela(system)
    assert len(cspm(system)) < 5_000
    assert len(dump(system)) < 5_000


@needs_spin
def test_spin_is_not_run_on_too_large_models() -> None:
    with pytest.raises(SpinError, match="1,048,616 commands"):
        deadlock_free(gathering(10, 4), Limits())
