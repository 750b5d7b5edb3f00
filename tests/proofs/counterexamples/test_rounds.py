"""Iterations of counted loops in the table of a counterexample: the first, the last, and one row for those in
between.
"""

from __future__ import annotations

import pytest

from cspdiag.proofs.counterexamples.counterexample import Party, Step
from cspdiag.proofs.counterexamples.rounds import FEWEST, repeated, shortened

Row = tuple[int, str, str | None]


def step(channel: str, value: object = None, *, added: bool = False) -> Step:
    kind = "time" if channel.startswith("wait") else "communication"
    return Step(kind, channel, None if value is None else str(value), (Party("p", "Main.p"),), added)  # type: ignore[arg-type]


def row_values(steps: list[Step]) -> list[Row]:
    return [(part.times, one.channel, one.value) for part in shortened(steps) for one in part.steps]


@pytest.mark.parametrize(
    ("values", "middle"),
    [
        (range(1000), "1 … 998"),
        (range(1000, 0, -1), "999 … 2"),
        (range(0, 500, 5), "5, 10 … 490"),
        ([7] * 40, "7"),
        ([None] * 40, None),
        (["1.5"] * 40, "1.5"),
        ([2**n for n in range(40)], f"2 to {2**38}"),
        ([n + 0.5 for n in range(40)], "1.5 to 38.5"),
        ([n + 0.1 + 0.2 for n in range(40)], "1.3 to 38.3"),
        ([None, *[3] * 38, 4], "3"),
        ([1, 2, 3, 5, 8, *range(9, 50)], "2 to 48"),
    ],
)
def test_values_that_count_are_summed_up(values: list[object], middle: str | None) -> None:
    rows = row_values([step("a", value) for value in values])
    first, *_, last = (None if value is None else str(value) for value in values)
    assert rows == [(1, "a", first), (len(values) - 2, "a", middle), (1, "a", last)]


def test_a_round_of_several_steps() -> None:
    rounds = [one for n in range(30) for one in (step("a", n), step("wait 1 ms"), step("b", 3))]
    assert row_values([step("c", 1), *rounds, step("c", 2)]) == [
        (1, "c", "1"),
        *[(1, "a", "0"), (1, "wait 1 ms", None), (1, "b", "3")],
        *[(28, "a", "1 … 28"), (28, "wait 1 ms", None), (28, "b", "3")],
        *[(1, "a", "29"), (1, "wait 1 ms", None), (1, "b", "3")],
        (1, "c", "2"),
    ]


@pytest.mark.parametrize(
    "values",
    [
        range(FEWEST + 1),
        [1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048],
        ["0.5", "1.5", "2.5", "3.5", "4.5", "5.5", "6.5", "7.5", "8.5", "9.5", "10.5"],
        [True, False, False, True, False, True, True, False, True, True, True, False],
    ],
)
def test_few_rounds_and_irregular_values_are_listed_one_by_one(values: list[object]) -> None:
    assert row_values([step("a", value) for value in values]) == [(1, "a", str(value)) for value in values]


def test_an_unexpected_value_is_reported() -> None:
    rows = row_values([step("a", value) for value in [*range(20), -1, *range(20, 40)]])
    assert rows == [
        *[(1, "a", "0"), (18, "a", "1 … 18"), (1, "a", "19")],
        (1, "a", "-1"),
        *[(1, "a", "20"), (18, "a", "21 … 38"), (1, "a", "39")],
    ]


def test_rounds_that_the_program_adds_are_shown_as_those_of_the_trace() -> None:
    added = [step("f", n, added=True) for n in range(457)]
    rows = row_values([step("a", 1), *added, step("f", 457), step("a", 2)])
    assert rows == [(1, "a", "1"), (1, "f", "0"), (456, "f", "1 … 456"), (1, "f", "457"), (1, "a", "2")]


def test_machines_have_added_rounds_only_once_where_they_are_the_same() -> None:
    once = [step("g", n, added=True) for n in range(3)]
    same = [step("f", 0, added=True), step("h", 1, added=True)] * 458
    parts = [(part.times, [one.value for one in part.steps]) for part in repeated([step("a", 1), *once, *same, *once])]
    assert parts == [(1, ["1"]), (1, ["0", "1", "2"]), (458, ["0", "1"]), (1, ["0", "1", "2"])]


def test_all_steps_are_counted() -> None:
    steps = [step("a" if n % 7 else "b", n // 3 if n % 50 else None) for n in range(2000)]
    assert sum(times for times, _, _ in row_values(steps)) == len(steps)
