"""Ticks of a sampled port."""

from __future__ import annotations

import pytest

from cspdiag.model.sampling import Sampling


@pytest.mark.parametrize(
    ("instant", "tick", "latest", "following"), [(0, True, 0, 5), (4, False, 0, 5), (10, True, 10, 15)]
)
def test_ticks_are_the_multiples_of_a_period(instant: int, tick: bool, latest: int, following: int) -> None:
    every = Sampling(5)
    assert (every.is_tick(instant), every.latest_tick(instant), every.next_tick(instant)) == (tick, latest, following)
