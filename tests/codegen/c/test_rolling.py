"""Statements that were unrolled become loops again."""

from __future__ import annotations

from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.base.sources import read_source
from cspdiag.codegen.c.text.code import Code, address, call, code, unsigned
from cspdiag.codegen.c.text.rolling import countable, rolled
from cspdiag.codegen.c.text.statements import Plain, lines, run

WORKERS = read_source(str(Path(__file__).parents[3] / "benchmarks" / "networks" / "workers.csp"))


def shown(*groups: list[Plain]) -> list[str]:
    return lines(rolled(groups))


def element(array: str, index: int) -> Code:
    return address(code(array).at(index))


def made(*arguments: Code) -> Plain:
    return run(call("make", *arguments))


def test_subscripts_that_count_become_a_loop() -> None:
    groups = [[made(element("cell", i), element("link", i + 1))] for i in range(4)]
    assert shown(*groups) == [
        "for (uint32_t i = 0U; i < 4U; i++) {",
        "    make(&cell[i], &link[i + 1U]);",
        "}",
    ]


def test_what_closes_the_ring_stays_outside_the_loop() -> None:
    groups = [[made(element("cell", i), element("link", (i + 1) % 5))] for i in range(5)]
    assert shown(*groups)[-1] == "make(&cell[4], &link[0]);"
    assert "i < 4U" in shown(*groups)[0]


def test_arguments_and_steps_other_than_one_count_too() -> None:
    groups = [[made(element("cell", i), countable(10 - i), unsigned(3 * i)), run("next++")] for i in range(3)]
    assert shown(*groups) == [
        "for (uint32_t i = 0U; i < 3U; i++) {",
        "    make(&cell[i], (int64_t)(10U - i), 3U * i);",
        "    next++;",
        "}",
    ]


def test_alternating_groups_make_one_loop() -> None:
    groups = [[made(element(name, i))] for i in range(3) for name in ("left", "right")]
    assert shown(*groups) == [
        "for (uint32_t i = 0U; i < 3U; i++) {",
        "    make(&left[i]);",
        "    make(&right[i]);",
        "}",
    ]


def test_few_or_irregular_statements_are_not_rolled() -> None:
    few = [[made(element("cell", i))] for i in range(2)]
    assert shown(*few) == ["make(&cell[0]);", "make(&cell[1]);"]
    groups = [[made(element("cell", i * i), countable(i))] for i in range(4)]
    assert shown(*groups) == [f"make(&cell[{i * i}], {i});" for i in range(4)]


def test_statements_that_do_not_count_are_not_repeated_by_a_loop() -> None:
    assert shown(*[[run("numbers++")]] * 3) == ["numbers++;"] * 3


@pytest.mark.parametrize("level", [0, 1])
def test_branches_of_a_parallel_that_differ_in_numbers_share_their_code(level: int) -> None:
    lengths = set()
    for size in ("20", "40"):
        network = pipeline.build(WORKERS, read_source, settings={"size": size}).network
        assert network is not None
        files = pipeline.generate(network, read_source, "c", level, observed=True)
        lengths.add(sum(len(text.splitlines()) for path, text in files.items() if path.startswith("pool")))
    assert len(lengths) == 1
