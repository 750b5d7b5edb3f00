"""What a specification allows, in words."""

from __future__ import annotations

import pytest

from cspdiag.proofs.refine.words import ended_too_soon


@pytest.mark.parametrize(
    ("values", "said"),
    [
        (["..-1", "0", "1.."], "`a`"),
        (["..4", "5.."], "`a`"),
        (["..-1", "1.."], "`a ..-1` and `a 1..`"),
        (["..-1", "0"], "`a ..-1` and `a.0`"),
        (["on", "off"], "`a.off` and `a.on`"),
        (["(passed on)", "..3", "4.."], None),
    ],
)
def test_all_numbers_are_any_number(values: list[str], said: str | None) -> None:
    found = ended_too_soon({("a", value) for value in values})
    if said is None:
        assert "`a`" not in found
    else:
        assert found == f"it ends, where the specification allows only {said}"
