"""A program that is half typed has all features, about the text as it is: a sample of ``tests.lsp.hunt``."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.lsp.hunt import ROOT, failures


@pytest.mark.parametrize(
    ("model", "every"),
    [
        ("models/dining/deadlock.csp", 2),
        ("models/emergency/emergency.csp", 31),
        ("models/watchdog/watchdog.csp", 41),
        ("models/jiwy/jiwy.csp", 401),
        ("cspdiag/std/control.csp", 301),
    ],
)
def test_everything_can_be_asked_where_a_token_is_missing(model: str, every: int) -> None:
    assert failures(ROOT / Path(model), every) == []
