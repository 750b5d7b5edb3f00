"""The searches answer as the plain interpretation does, on random systems: deadlock, knots, numbers of states and
lengths of shortest traces.
"""

from __future__ import annotations

from collections.abc import Callable

import pytest

from cspdiag.proofs.properties import cycles, livelock, termination
from cspdiag.proofs.reduce import minimization, reduction
from cspdiag.proofs.search import breadth_first, one_by_one, stubborn
from cspdiag.proofs.transitions.systems.system import System
from cspdiag.proofs.verdict import Limits, Proved, Refuted, Verdict
from tests.proofs.systems import naive
from tests.proofs.systems.random_systems import random_system

SEEDS = range(250)


def first_layer(system: System, holds: Callable[[System, naive.State], bool]) -> int | None:
    return next(
        (depth for depth, layer in enumerate(naive.layers(system)) if any(holds(system, state) for state in layer)),
        None,
    )


def check(system: System, verdict: Verdict, holds: Callable[[System, naive.State], bool], *, shortest: bool) -> bool:
    """Compare with the truth. Returns whether the property holds."""
    depth = first_layer(system, holds)
    if depth is None:
        assert isinstance(verdict, Proved)
        return True
    assert isinstance(verdict, Refuted)
    assert holds(system, naive.replay(system, verdict.trace))
    assert len(verdict.trace) == depth if shortest else len(verdict.trace) >= depth
    return False


@pytest.mark.parametrize(
    ("search", "holds", "shortest"),
    [
        (breadth_first.deadlock_free, naive.deadlocked, True),
        (breadth_first.knot_free, naive.knotted, True),
        (one_by_one.deadlock_free, naive.deadlocked, True),
        (one_by_one.knot_free, naive.knotted, True),
        (stubborn.deadlock_free, naive.deadlocked, False),
        (minimization.deadlock_free, naive.deadlocked, False),
        (minimization.knot_free, naive.knotted, False),
        (stubborn.knot_free, naive.knotted, False),
    ],
)
def test_a_search_answers_as_the_plain_interpretation_does(
    search: Callable[[System, Limits], Verdict],
    holds: Callable[[System, naive.State], bool],
    shortest: bool,
) -> None:
    systems = [random_system(seed) for seed in SEEDS]
    if search is stubborn.knot_free:
        systems = [system for system in systems if all(event.kind != "failure" for event in system.events)]
    answers = [check(system, search(system, Limits()), holds, shortest=shortest) for system in systems]
    assert 30 < sum(answers) < len(answers) - 30, "both answers appear often"


@pytest.mark.parametrize(
    ("brief_search", "large", "vectors"), [(0, False, True), (0, False, False), (3000, False, True), (0, True, True)]
)
@pytest.mark.parametrize(
    ("search", "holds", "fewest"),
    [(livelock.livelock_free, naive.livelocked, 30), (termination.terminates, naive.never_ends, 8)],
)
def test_endless_runs_are_found_as_the_plain_interpretation_finds_them(
    search: Callable[[System, Limits], Verdict],
    holds: Callable[[System, naive.State], bool],
    fewest: int,
    brief_search: int,
    large: bool,
    vectors: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(cycles, "has_vectors", lambda: vectors)
    monkeypatch.setattr(cycles, "_BRIEF_SEARCH_STATES", brief_search)
    monkeypatch.setattr(reduction, "_WORTH_WHILE", 0 if large else 10**6)
    true = 0
    for seed in SEEDS:
        system = random_system(seed)
        verdict = search(system, Limits())
        true += check(system, verdict, holds, shortest=False)
        if isinstance(verdict, Refuted):
            end = naive.replay(system, verdict.trace)
            assert naive.replay(system, verdict.trace + verdict.cycle) == end, f"seed {seed}"
    assert fewest < true < len(SEEDS) - 30, "both answers appear often"


def test_all_reachable_states_and_deadlocks_are_counted() -> None:
    for seed in SEEDS:
        system = random_system(seed)
        states = [state for layer in naive.layers(system) for state in layer]
        deadlocks = sum(naive.deadlocked(system, state) for state in states)
        assert breadth_first.count(system, Limits()) == (len(states), deadlocks), f"seed {seed}"


def test_one_by_one_reaches_as_many_states_as_by_vectors() -> None:
    for seed in SEEDS:
        system = random_system(seed)
        found = one_by_one.explore(system, Limits(), lambda state, can_step: ())
        assert len(found.states) == breadth_first.count(system, Limits())[0]
