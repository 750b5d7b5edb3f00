"""Loops behind statements that were unrolled."""

from __future__ import annotations

from cspdiag.codegen.c.text.rolling import marked, rolled
from cspdiag.codegen.c.text.rows import lines


def shown(*groups: list[str]) -> list[str]:
    return lines(rolled(groups))


def test_subscripts_that_count_become_a_loop() -> None:
    groups = [[f"make(&cell[{i}], &link[{i + 1}]);"] for i in range(4)]
    assert shown(*groups) == [
        "for (uint32_t i = 0U; i < 4U; i++) {",
        "    make(&cell[i], &link[i + 1U]);",
        "}",
    ]


def test_what_closes_the_ring_stays_outside_the_loop() -> None:
    groups = [[f"make(&cell[{i}], &link[{(i + 1) % 5}]);"] for i in range(5)]
    assert shown(*groups)[-1] == "make(&cell[4], &link[0]);"
    assert "i < 4U" in shown(*groups)[0]


def test_arguments_and_steps_other_than_one_count_too() -> None:
    groups = [[f"make(&cell[{i}], {marked(10 - i)}, {3 * i}U);", "next++;"] for i in range(3)]
    assert shown(*groups) == [
        "for (uint32_t i = 0U; i < 3U; i++) {",
        "    make(&cell[i], (int64_t)(10U - i), (3U * i));",
        "    next++;",
        "}",
    ]


def test_a_few_or_irregular_ones_stay_as_they_are() -> None:
    assert shown(["make(&cell[0]);"], ["make(&cell[1]);"]) == ["make(&cell[0]);", "make(&cell[1]);"]
    groups = [[f"make(&cell[{i * i}], {marked(i)});"] for i in range(4)]
    assert shown(*groups) == [f"make(&cell[{i * i}], {i});" for i in range(4)]


def test_statements_that_do_not_count_are_not_repeated_by_a_loop() -> None:
    assert shown(*[["numbers++;"]] * 3) == ["numbers++;"] * 3
