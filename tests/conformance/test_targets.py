"""Every target behaves like the reference, on all models, all disputed cases, and random programs."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import pytest

from tests.conformance import numbered_lines
from tests.conformance.hunt import A_START, hunt
from tests.conformance.kit import judge, parsed
from tests.conformance.sources import JUST_AFTER, MODELS, PROGRAMS, environments
from tests.conformance.targets import TARGETS, Target
from tests.support.thorough import in_turn

EXAMPLES = int(os.environ.get("CONFORMANCE_EXAMPLES", "15"))
"""How many random programs each target is compared on, rounded down to multiples of a start; this, and all of
``tests.conformance``, should take three minutes on two cores.
"""


@pytest.fixture
def target(request: pytest.FixtureRequest) -> Target:
    target: Target = request.param
    reason = target.unavailable()
    if reason is not None:
        pytest.skip(f"{target.name}: {reason}")
    return target


on_every_target = pytest.mark.parametrize("target", TARGETS.values(), ids=TARGETS, indirect=True)
"""As the outermost mark, so the targets follow each other on one program, whose network and reference are kept."""


def assert_certified(target: Target, name: str, limit: int) -> None:
    """The program of a file has equal traces on the target, or the target refuses it."""
    network = parsed(name)
    for environment in environments(network):
        verdict = judge(target, network, environment, limit + JUST_AFTER, name)
        if verdict.result == "refused":
            pytest.skip(f"{target.name}: {verdict.details}")
        assert verdict.result == "equal", verdict.details


def on_usual_targets(names: Sequence[str]) -> pytest.MarkDecorator:
    """Each program on the targets that share least, and on one of the others in turn; on all if tests are thorough."""
    alike = ("python-O1-observed", "python-O1-untraced", "c-O0", "c-O1-observed")
    in_its_turn = set(in_turn(names, alike))
    chosen = [
        pytest.param(target, name, id=f"{target.name}-{name}")
        for name in names
        for target in TARGETS.values()
        if target.name not in alike or (name, target.name) in in_its_turn
    ]
    return pytest.mark.parametrize(("target", "name"), chosen, indirect=["target"])


@on_usual_targets(MODELS)
def test_model(target: Target, name: str) -> None:
    assert_certified(target, name, 1_200_000_000)


@on_usual_targets(PROGRAMS)
def test_program(target: Target, name: str) -> None:
    """Programs on which implementations have disagreed."""
    assert_certified(target, name, 100_000_000)


@on_every_target
def test_numbered_lines(target: Target, tmp_path: Path) -> None:
    file = tmp_path / "main.csp"
    file.write_text(numbered_lines.program(), encoding="utf-8")
    assert_certified(target, str(file), 100_000_000)


@on_every_target
@pytest.mark.parametrize("start", range(EXAMPLES // A_START))
def test_random_programs(target: Target, start: int) -> None:
    found = hunt(target, A_START, start, shrink=False)
    assert found is None, found
