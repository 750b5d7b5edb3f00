"""A slice of the hunt: of random programs that are proved none misses a sample."""

from __future__ import annotations

from tests.analyses.timing.hunt import hunt


def test_what_is_proved_of_random_programs_holds_in_their_runs() -> None:
    found = hunt(0, 75)
    assert found.wrong == []
    assert found.answers["proved"] >= 20
    assert found.answers["unknown"] >= 10
