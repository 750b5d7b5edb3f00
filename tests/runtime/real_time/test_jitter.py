"""How late ticks were, in figures."""

from __future__ import annotations

from math import ceil

from hypothesis import given
from hypothesis import strategies as st

from cspdiag.runtime import Jitter, ms, us


def jitter_of(lateness: list[int]) -> Jitter:
    jitter = Jitter()
    for late in lateness:
        jitter.add(late)
    return jitter


@given(st.lists(st.integers(0, 2**40), min_size=1), st.sampled_from([0.01, 0.5, 0.9, 0.99, 1.0]))
def test_a_part_of_the_ticks_is_bounded_closely(lateness: list[int], part: float) -> None:
    exact = sorted(lateness)[ceil(part * len(lateness)) - 1]
    assert exact <= jitter_of(lateness).below(part) <= exact * 17 / 16 + 1


def test_it_reads_as_a_line() -> None:
    assert str(jitter_of([100 * us] * 99 + [3 * ms])) == (
        "mean 129 us, deviation 288.546 us, 99 % within 102.4 us, worst 3 ms"
    )


def test_no_tick_is_no_lateness() -> None:
    assert (Jitter().below(0.99), Jitter().worst, Jitter().mean, Jitter().deviation) == (0, 0, 0.0, 0.0)
