"""Parentheses in both languages: all that the meaning needs, and no others."""

from __future__ import annotations

import ast
from itertools import product

import pytest

from cspdiag.codegen.c.text import code as c
from cspdiag.codegen.python.text import code as python
from cspdiag.codegen.python.text.operators import infix

OPERATORS = {
    "or": python.OR, "and": python.AND, "<": python.COMPARISON, "==": python.COMPARISON, "|": python.BITS_OR,
    "&": python.BITS_AND, "<<": python.SHIFT, "+": python.SUM, "-": python.SUM, "*": python.PRODUCT,
    "/": python.PRODUCT,
}  # fmt: skip


@pytest.mark.parametrize(("outer", "inner"), list(product(OPERATORS, repeat=2)))
def test_python_reads_what_was_built(outer: str, inner: str) -> None:
    x, y, z = map(python.Name, "xyz")
    inside = infix(inner, OPERATORS[inner], x, y)
    for built, expected in (
        (infix(outer, OPERATORS[outer], inside, z), f"(x {inner} y) {outer} z"),
        (infix(outer, OPERATORS[outer], z, inside), f"z {outer} (x {inner} y)"),
    ):
        same = ast.dump(ast.parse(built.flat)) == ast.dump(ast.parse(expected))
        chained = outer == inner in ("and", "or")  # Python itself makes one node of a chain of them
        assert same or chained, built.flat


@pytest.mark.parametrize(
    ("outer", "first", "second"),
    [
        ("||", "(a + b) || c", "c || (a + b)"),
        ("&&", "(a + b) && c", "c && (a + b)"),
        ("==", "a + b == c", "c == a + b"),
        ("<", "a + b < c", "c < a + b"),
        ("-", "a + b - c", "c - (a + b)"),
        ("*", "(a + b) * c", "c * (a + b)"),
    ],
)
def test_sums_in_c_stand_as_misra_has_them(outer: str, first: str, second: str) -> None:
    levels = {"||": c.OR, "&&": c.AND, "==": c.EQUALITY, "<": c.RELATION, "-": c.SUM, "*": c.PRODUCT}
    a, b, other = map(c.Atom, "abc")
    total = c.infix("+", c.SUM, a, b)
    assert str(c.infix(outer, levels[outer], total, other)) == first
    assert str(c.infix(outer, levels[outer], other, total)) == second


def test_rows_of_conditions_need_no_parentheses() -> None:
    parts = [c.Atom(name) for name in "abc"]
    row = c.infix("&&", c.AND, c.infix("&&", c.AND, parts[0], parts[1]), parts[2])
    assert str(row) == "a && b && c"
    assert str(c.infix("||", c.OR, row, parts[0])) == "(a && b && c) || a"
    both = infix("and", python.AND, python.Name("a"), python.Name("b"))
    mixed = infix("or", python.OR, both, python.NONE)
    assert mixed.flat == "(a and b) or None"
