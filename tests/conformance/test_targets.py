"""Every target behaves like the reference, on all models, all disputed cases, and random programs."""

from __future__ import annotations

import os
from itertools import product
from pathlib import Path

import pytest

from tests.conformance import numbered_lines
from tests.conformance.hunt import A_START, hunt
from tests.conformance.kit import judge, parsed
from tests.conformance.sources import JUST_AFTER, MODELS, PROGRAMS, environments
from tests.conformance.targets import TARGETS, Target
from tests.support.thorough import THOROUGH, in_turn

EXAMPLES = int(os.environ.get("CONFORMANCE_EXAMPLES", "15"))
"""How many random programs each target is compared on, rounded down to multiples of a start; this, and all of
``tests.conformance``, should take three minutes on two cores.
"""


@pytest.fixture
def target(request: pytest.FixtureRequest) -> Target:
    target: Target = TARGETS[request.param]
    reason = target.unavailable()
    if reason is not None:
        pytest.skip(f"{target.name}: {reason}")
    return target


def assert_certified(target: Target, name: str, limit: int) -> None:
    """The program of a file has equal traces on the target, or the target refuses it."""
    network = parsed(name)
    for environment in environments(network):
        verdict = judge(target, network, environment, limit + JUST_AFTER, name)
        if verdict.result == "refused":
            pytest.skip(f"{target.name}: {verdict.details}")
        assert verdict.result == "equal", verdict.details


DISTINCT = ("python-O0", "python-O1", "c-O0-steps", "c-O1")
"""The targets that share least. Those of one program follow each other: its network and what the reference does are
kept.
"""
ALIKE = ("python-O1-observed", "python-O1-untraced", "c-O1-observed", "c-O0")


@pytest.mark.parametrize(
    ("name", "target"), sorted([*product(MODELS, DISTINCT), *in_turn(MODELS, ALIKE)]), indirect=["target"]
)
def test_model(target: Target, name: str) -> None:
    assert_certified(target, name, 1_200_000_000)


@pytest.mark.parametrize(
    ("name", "target"),
    sorted([*product(PROGRAMS, DISTINCT[:2]), *in_turn(PROGRAMS, DISTINCT[2:]), *in_turn(PROGRAMS, ALIKE)]),
    indirect=["target"],
)
def test_program(target: Target, name: str) -> None:
    """Programs on which implementations have disagreed."""
    assert_certified(target, name, 100_000_000)


@pytest.mark.parametrize("target", TARGETS, indirect=True)
def test_numbered_lines(target: Target, tmp_path: Path) -> None:
    file = tmp_path / "main.csp"
    file.write_text(numbered_lines.program(), encoding="utf-8")
    assert_certified(target, str(file), 100_000_000)


@pytest.mark.parametrize("target", TARGETS if THOROUGH else DISTINCT, indirect=True)
@pytest.mark.parametrize("start", range(EXAMPLES // A_START))
def test_random_programs(target: Target, start: int) -> None:
    found = hunt(target, A_START, start, shrink=False)
    assert found is None, found
