"""Ticks of a sampled port."""

from __future__ import annotations

import pytest

from cspdiag.model.sampling import Sampling
from cspdiag.runtime.outside.ticks import Ticks


@pytest.mark.parametrize("period", [1, 5, 7])
def test_ticks_are_an_offset_after_the_multiples_of_a_period_and_later_than_the_start(period: int) -> None:
    for offset in range(period):
        ticks = [k * period + offset for k in range(20) if k * period + offset > 0]
        sampling = Sampling(period, offset)
        for instant in range(1, 10 * period):
            assert sampling.is_tick(instant) == (instant in ticks)
            assert sampling.next_tick(instant) == min(tick for tick in ticks if tick > instant)
            latest = max((tick for tick in ticks if tick <= instant), default=None)
            assert sampling.latest_tick(instant) == latest or (latest is None and sampling.latest_tick(instant) <= 0)
        assert sampling.next_tick(0) == ticks[0]


@pytest.mark.parametrize("offset", [0, 2])
def test_the_runtime_has_the_same_ticks(offset: int) -> None:
    for instant in range(1, 20):
        assert Ticks(5, offset).at(instant) == Sampling(5, offset).is_tick(instant)
        assert Ticks(5, offset).after(instant) == Sampling(5, offset).next_tick(instant)


def test_an_offset_is_reported_where_there_is_one() -> None:
    assert (str(Sampling(10_000_000)), Sampling(10_000_000).every) == ("10 ms", "every 10 ms")
    shifted = Sampling(10_000_000, 2_000_000)
    assert (str(shifted), shifted.every) == ("10 ms offset 2 ms", "every 10 ms with an offset of 2 ms")
