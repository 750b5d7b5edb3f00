"""Durations written for people."""

from __future__ import annotations

import pytest

from cspdiag.model.constants.durations import rounded


@pytest.mark.parametrize(
    ("nanoseconds", "written"),
    [
        (0, "0"),
        (0.25, "0.25 ns"),
        (999, "999 ns"),
        (1_250_000, "1.25 ms"),
        (-500_000, "-500 us"),
        (9_509_312.7, "9.509 ms"),
        (999_940, "999.9 us"),
        (999_960, "1 ms"),
        (65_000_000_000, "65 s"),
    ],
)
def test_four_digits_in_the_unit_that_has_a_whole_one(nanoseconds: float, written: str) -> None:
    assert rounded(nanoseconds) == written
