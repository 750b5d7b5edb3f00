"""Loops found behind unrolled code, and what looking for them costs."""

from __future__ import annotations

from functools import partial

import pytest

from cspdiag.codegen.python.text import rolling as python_rolling
from cspdiag.codegen.python.text.code import Atom
from cspdiag.codegen.python.text.statements import Line, Statement, lines
from tests.support.counting import calls


def statement(text: str) -> tuple[Statement, ...]:
    return (Line("await ", Atom(text)),)


def rolled(texts: list[str]) -> list[str]:
    return list(lines(python_rolling.rolled_steps([statement(text) for text in texts], "i"), ""))


def test_a_part_that_counts_becomes_a_loop() -> None:
    assert rolled(["a.x", "c[4].f()", "c[5].f()", "c[6].f()", "b.x"]) == [
        "await a.x",
        "for i in range(3):",
        "    await c[i + 4].f()",
        "await b.x",
    ]


def test_rounds_of_several_statements_become_a_loop() -> None:
    texts = [text for number in range(4) for text in (f"c[{number}].f()", f"d[{number + 1}].g()")]
    assert rolled([*texts, "e[9].f()"]) == [
        "for i in range(4):",
        "    await c[i].f()",
        "    await d[i + 1].g()",
        "await e[9].f()",
    ]


def test_equal_statements_need_no_index() -> None:
    assert rolled(["f()"] * 5) == ["for _ in range(5):", "    await f()"]


@pytest.mark.parametrize(
    "text",
    [
        pytest.param(lambda number: f"choice_{number}.select()", id="counts, but not in an index"),
        pytest.param(lambda number: f"c[{number}].f()", id="counts"),
        pytest.param(lambda number: f"c[{number * number}].f()", id="counts irregularly"),
        pytest.param(lambda number: f"c[{number % 7}].f()", id="counts again and again"),
    ],
)
def test_twice_as_many_statements_cost_twice_as_much(text: object) -> None:
    assert callable(text)
    small, large = (calls(partial(rolled, [text(number) for number in range(size)])) for size in (200, 400))
    assert large < 2.5 * small
