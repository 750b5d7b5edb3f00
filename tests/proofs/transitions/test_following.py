"""A transition system allows every run of its program, and ends as the run ends."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, note, settings

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.network.ir.network import Network
from cspdiag.proofs.transitions import transition_system
from cspdiag.proofs.transitions.classes.own_guards import guard_met_by_its_body
from cspdiag.proofs.transitions.systems.system import System
from cspdiag.simulate.result import Run
from cspdiag.simulate.run.execute import simulate
from tests.conformance.sources import environments, network_of, read
from tests.proofs.transitions.following import Lost, follow, has_ended, is_stuck, observed
from tests.properties.encounters import encounters
from tests.properties.programs import programs

ROOT = Path(__file__).parents[3]
MODELS = ("buffer", "cascade", "commstime", "dining/deadlock", "dining", "emergency", "jiwy", "ring", "watchdog")
PROGRAMS = sorted((ROOT / "tests/conformance/programs").glob("*.csp"))
TOO_LARGE = {"branches_in_runs", "branches_of_one_body", "fair_choice_among_many"}
"""These have too many states: the explored part is allowed, and no more is known."""
TOO_LARGE_TO_BUILD = {"turns_that_differ_by_values"}
"""Of these one process alone has some 100,000 places."""
LONGEST = 120
"""The maximum number of communications to follow."""


def network_named(name: str) -> Network:
    folder, _, file = name.partition("/")
    return network_of(read(str(ROOT / "models" / folder / f"{file or folder}.csp")))


def run_of(network: Network) -> Run:
    files = pipeline.generate(network, read, traced=True, observed=True)
    return simulate(network, files, environment=environments(network)[0], until=60_000_000)


def assert_allowed(network: Network, run: Run, limit: int = 60_000) -> bool:
    """Whether the run was followed; that may take too many states."""
    communications = [(entry.channel, entry.value) for entry in run.communications]
    return is_followed(transition_system(network), network, communications, run.outcome.ended, limit)


def is_followed(
    system: System, network: Network, made: Iterable[tuple[str, Any]], ended: str, limit: int = 60_000
) -> bool:
    """Whether a run that made some communications and ``ended`` was followed; that may take too many states. Raises
    Lost if it is not allowed.
    """
    communications, unseen = observed(network, made)
    condition = {"terminated": has_ended, "deadlock": is_stuck}.get(ended)
    if condition is None or len(communications) > LONGEST:
        return follow(system, communications[:LONGEST], unseen, limit=limit) is not None
    return follow(system, communications, unseen, condition, limit) is not None


@pytest.mark.parametrize("name", MODELS)
def test_model(name: str) -> None:
    network = network_named(name)
    assert assert_allowed(network, run_of(network))


@pytest.mark.parametrize("path", PROGRAMS, ids=lambda path: path.stem)
def test_program_that_is_hard_to_get_right(path: Path) -> None:
    network = network_of(read(str(path)))
    if path.stem in TOO_LARGE_TO_BUILD:
        pytest.skip("its transition system is built for half a minute")
    if guard_met_by_its_body(network) is not None:
        pytest.skip("its transition system is no basis of a proof")
    assert assert_allowed(network, run_of(network)) or path.stem in TOO_LARGE


@settings(max_examples=20, deadline=None, suppress_health_check=list(HealthCheck))
@given(programs() | encounters())
def test_random_program(text: str) -> None:
    note(text)

    def nothing(path: str) -> SourceFile:
        raise FileNotFoundError(path)

    network = pipeline.build(SourceFile(name="random.csp", text=text), nothing).network
    assert network is not None
    assert_allowed(network, run_of(network), limit=15_000)


@pytest.mark.parametrize("name", ["commstime", "dining", "ring"])
def test_run_with_a_communication_left_out_is_not_allowed(name: str) -> None:
    network = network_named(name)
    run = run_of(network)
    communications, unseen = observed(network, ((entry.channel, entry.value) for entry in run.communications))
    system = transition_system(network)
    assert len(communications) > 10
    lost = 0
    for left_out in range(10):
        try:
            follow(system, communications[:left_out] + communications[left_out + 1 : 40], unseen)
        except Lost:
            lost += 1
    assert lost >= 5
