"""Ticks of a sample period."""

from __future__ import annotations

import pytest

from cspdiag.base.ticks import is_tick, latest_tick, next_tick


@pytest.mark.parametrize(
    ("instant", "tick", "latest", "following"), [(0, True, 0, 5), (4, False, 0, 5), (10, True, 10, 15)]
)
def test_ticks_are_the_multiples_of_a_period(instant: int, tick: bool, latest: int, following: int) -> None:
    assert (is_tick(instant, 5), latest_tick(instant, 5), next_tick(instant, 5)) == (tick, latest, following)
