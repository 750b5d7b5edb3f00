"""Loops found in unrolled code, and the cost of finding them."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import pytest

from cspdiag.codegen.python.text import rolling as python_rolling
from cspdiag.codegen.python.text.code import SUM, Code, Constant, Name, WholeNumber, awaited
from cspdiag.codegen.python.text.operators import infix
from cspdiag.codegen.python.text.statements import lines, run
from cspdiag.codegen.shared.trees import Outline, outlines_of, repeated
from cspdiag.network.elaborate.fewer.extrapolation import Extrapolation
from cspdiag.network.elaborate.fewer.runs import outline as rows_outline
from tests.support.counting import calls


def called(name: str, index: int | None, method: str, *arguments: Code) -> Code:
    owner = Name(name) if index is None else Name(name).at(index)
    return owner.call(method, *arguments)


def rolled(codes: list[Code]) -> list[str]:
    return lines(python_rolling.rolled_steps([(run(awaited(code)),) for code in codes], lambda _: "i"))


def test_a_part_that_counts_becomes_a_loop() -> None:
    parts = [called("c", index, "f") for index in (4, 5, 6)]
    assert rolled([called("a", None, "x"), *parts, called("b", None, "x")]) == [
        "await a.x()",
        "for i in range(3):",
        "    await c[i + 4].f()",
        "await b.x()",
    ]


def test_rounds_of_several_statements_become_a_loop() -> None:
    codes = [code for number in range(4) for code in (called("c", number, "f"), called("d", number + 1, "g"))]
    assert rolled([*codes, called("e", 9, "f")]) == [
        "for i in range(4):",
        "    await c[i].f()",
        "    await d[i + 1].g()",
        "await e[9].f()",
    ]


def test_equal_statements_need_no_index() -> None:
    assert rolled([called("a", None, "f")] * 5) == ["for _ in range(5):", "    await a.f()"]


def test_a_number_that_counts_beside_an_operator_is_a_sum_in_parentheses() -> None:
    codes = [called("c", n, "f", infix("-", SUM, Name("x"), WholeNumber(n + 1))) for n in range(3)]
    assert rolled(codes) == ["for i in range(3):", "    await c[i].f(x - (i + 1))"]


def test_other_operators_are_no_loop() -> None:
    operators = ("+", "-", "+")
    codes = [called("c", n, "f", infix(sign, SUM, Name("x"), Name("y"))) for n, sign in enumerate(operators)]
    elements = [called("c", n, "f", infix(sign, SUM, Name("x"), Name("y"))) for n, sign in enumerate(operators)]
    assert len(rolled(codes)) == 3
    assert python_rolling.template(elements, "i") is None


def test_a_string_that_looks_like_an_element_does_not_count() -> None:
    assert len(rolled([called("a", None, "f", Constant(f'"c[{n}]"')) for n in range(3)])) == 3


@pytest.mark.parametrize(
    "code",
    [
        pytest.param(lambda number: called(f"choice_{number}", None, "select"), id="counts, but not in an index"),
        pytest.param(lambda number: called("c", number, "f"), id="counts"),
        pytest.param(lambda number: called("c", number * number, "f"), id="counts irregularly"),
        pytest.param(lambda number: called("c", number % 7, "f"), id="counts again and again"),
    ],
)
def test_twice_as_many_statements_cost_twice_as_much(code: Callable[[int], Code]) -> None:
    small, large = (calls(partial(rolled, [code(number) for number in range(size)])) for size in (200, 400))
    assert large < 2.5 * small


def test_outlines_of_rows_that_are_known_to_repeat_are_those_of_each() -> None:
    def cells(size: int) -> tuple[object, ...]:
        pairs = [(word, index, size) for index in range(size) for word in ("one", "two")]
        return (("cell", 0, 7), *[("cell", index, 2 * index) for index in range(2, size)], "between", *pairs, *pairs)

    made: list[object] = []

    def outlined(row: object) -> Outline:
        made.append(row)
        found = rows_outline(row)
        return Outline(found.shape, found.numbers)

    rows = Extrapolation(24, 48, 600).of(cells(24), cells(48))
    known = outlines_of(rows, outlined)
    assert len(made) < 30
    each = [outlined(row) for row in rows]
    assert list(known) == each
    assert known[5:9] == each[5:9]
    for start in (0, 1, 2, 300, 598, 599, 600, 601, 602, 1800, 1801, 2995):
        for counts in (any, all, lambda steps: all(step in (0, 1) for step in steps)):
            assert repeated(known, start, counts) == repeated(each, start, counts)
