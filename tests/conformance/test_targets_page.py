"""``docs/targets.md`` lists what exists: every action, event, medium, pass and member; and its miniature target is
certified.
"""

from __future__ import annotations

import re
import typing
from pathlib import Path

import pytest

from cspdiag.network.ir import actions as act
from cspdiag.network.ir.network import MediumKind
from cspdiag.optimize import PASSES
from tests.conformance.kit import LIBRARY_FUNCTIONS, judge, parsed
from tests.conformance.sources import MODELS, environments
from tests.conformance.targets import Target

PAGE = (Path(__file__).parents[2] / "docs" / "targets.md").read_text(encoding="utf-8")


def rows(heading: str) -> set[str]:
    """What comes first in the rows of the tables of a section, in backquotes."""
    section = PAGE.partition(f"\n## {heading}\n")[2].partition("\n## ")[0]
    return set(re.findall(r"^\| `(\w+)` \|", section, re.MULTILINE))


def names(union: object) -> set[str]:
    return {(typing.get_origin(member) or member).__name__ for member in typing.get_args(union)}


def test_every_action_and_event() -> None:
    assert rows("Actions") == names(act._Leaf) | names(act._Composed) | names(act.MadeAction) | names(act.Event)


def test_every_medium() -> None:
    assert rows("Media") == set(typing.get_args(MediumKind))


def test_every_pass_in_order() -> None:
    section = PAGE.partition("\n## What a target gets\n")[2].partition("\n## ")[0]
    assert re.findall(r"^\| `(\w+)` \|", section, re.MULTILINE) == [entry.name for entry in PASSES]


def test_every_member_of_a_target() -> None:
    assert rows("Certification") == {name for name in vars(Target) if not name.startswith("_")}


def test_functions_of_the_library() -> None:
    paragraph = PAGE.partition("**Floating point.**")[2].partition("\n\n")[0]
    reported = paragraph.partition("The functions")[2].partition("are the C library's")[0]
    assert set(re.findall(r"`([a-z0-9^]+)`", reported)) == LIBRARY_FUNCTIONS


@pytest.fixture(scope="module")
def miniature() -> Target:
    (code,) = re.findall(r"^```python\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    made: dict[str, type[Target]] = {}
    exec(code, made)
    return made["Miniature"]()


def test_miniature_runs_the_ring(miniature: Target) -> None:
    verdict = judge(miniature, parsed("models/ring/ring.csp"), None, 1_000_000_001)
    assert (verdict.result, verdict.details) == ("equal", "")


@pytest.mark.parametrize("name", [name for name in MODELS if "ring" not in name])
def test_miniature_refuses_everything_else(miniature: Target, name: str) -> None:
    network = parsed(name)
    for environment in environments(network):
        assert judge(miniature, network, environment, 10_000_001).result == "refused"
