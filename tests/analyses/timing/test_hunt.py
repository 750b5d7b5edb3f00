"""A part of the hunt: no random program that is proved misses a sample, and in random chains no output is older, and no
change seen later, than was reported.
"""

from __future__ import annotations

from tests.analyses.timing.hunt import hunt, hunt_ages


def test_what_is_proved_of_random_programs_holds_in_their_runs() -> None:
    found = hunt(0, 24)
    assert found.wrong == []
    assert found.answers["proved"] >= 6
    assert found.answers["unknown"] >= 6


def test_ages_and_reactions_of_random_chains_hold_where_hops_end_at_ticks() -> None:
    found = hunt_ages(0, 24)
    assert found.wrong == []
    assert found.answers["proved"] >= 14
    assert found.answers["age reached"] >= 3
    assert found.answers["reaction reached"] >= 3
    # Some may keep values or pass on only some samples: these have no bound.
    assert 7 <= found.answers["age bounded"] <= found.answers["proved"] - 3
    assert 6 <= found.answers["reaction bounded"] <= found.answers["age bounded"]
