"""Traps are what they claim to be: no step of the system empties one."""

from __future__ import annotations

import pytest

from cspdiag.proofs.structure.pairs import Structure
from cspdiag.proofs.structure.traps import Place, Traps
from cspdiag.proofs.transitions.systems.system import System
from tests.proofs.systems import known, naive
from tests.proofs.systems.random_networks import random_network


def never_empty(system: System, trap: list[Place]) -> bool:
    """Whether every reachable state takes a place of the trap."""
    return all(
        any(state[component] == local for component, local in trap) for layer in naive.layers(system) for state in layer
    )


def test_the_token_of_a_ring_is_always_somewhere() -> None:
    system = known.token_ring(4)
    # No station has the token: every station is idle, in its initial state only if it had no token.
    idle = [
        part.edges.index(system.components[1].edges[0]) if at == 99 else 1 for at, part in enumerate(system.components)
    ]
    without = [1, *[0] * 3]
    assert idle
    trap = Traps(Structure(system)).avoiding(without)
    assert trap is not None
    assert not {(component, state) for component, state in enumerate(without)} & set(trap)
    assert never_empty(system, trap)


def test_what_is_reachable_is_avoided_by_no_trap() -> None:
    system = known.philosophers(3)
    traps = Traps(Structure(system))
    for layer in naive.layers(system)[:6]:
        for state in layer:
            assert traps.avoiding(state) is None


@pytest.mark.parametrize("form", ["tokens", "anything", "cycles"])
def test_smaller_traps_are_traps_too(form: str) -> None:
    found = 0
    for seed in range(60):
        system = random_network(seed, form=form, components=4)  # type: ignore[arg-type]
        traps = Traps(Structure(system))
        reachable = {state for layer in naive.layers(system) for state in layer}
        for state in reachable:
            assert traps.avoiding(state) is None
        for local in range(max(len(part.edges) for part in system.components)):
            state = tuple(min(local, len(part.edges) - 1) for part in system.components)
            trap = traps.avoiding(state)
            if trap is not None:
                found += 1
                assert never_empty(system, trap)
                smaller = traps.smaller(trap)
                assert set(smaller) <= set(trap)
                assert never_empty(system, smaller)
    assert found > 5
