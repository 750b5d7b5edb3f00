from __future__ import annotations

from cspdiag.network.lower.distinct_names import DistinctNames


def test_names_wanted_again_are_numbered_around_those_that_are_taken() -> None:
    names = DistinctNames(["turn_2", "other"])
    assert [names.fresh("turn", lambda number: f"turn_{number}") for _ in range(3)] == ["turn", "turn_3", "turn_4"]
    assert names.fresh("other", lambda number: f"other_{number}") == "other_2"


def test_a_thousand_equal_names_cost_a_thousand_steps() -> None:
    names = DistinctNames()
    tried: list[int] = []

    def numbered(number: int) -> str:
        tried.append(number)
        return f"choice_{number}"

    given = [names.fresh("choice", numbered) for _ in range(1000)]
    assert len(set(given)) == 1000
    assert len(tried) <= 2 * 1000
