"""Documents: what is on one line, and where a line that does not fit is broken."""

from __future__ import annotations

import pytest

from cspdiag.codegen.shared.document import (
    LINE,
    SOFT,
    Document,
    Fill,
    FirstThatFits,
    Flat,
    Group,
    Nest,
    flat,
    joined,
    listed,
    render,
)

CALL: Document = ("f(", Nest(2, Fill(listed(["alpha", "beta", "gamma"]))), ")")
BLOCK: Document = Group(("{", Nest(2, (SOFT, joined(LINE, listed(["a = 1", "b = 2"])))), SOFT, "}"))


@pytest.mark.parametrize("document", [CALL, BLOCK, FirstThatFits((CALL, BLOCK))])
def test_what_fits_is_on_one_line(document: Document) -> None:
    assert render(document, 80) == [flat(document)]


def test_a_group_breaks_all_its_lines() -> None:
    assert render(BLOCK, 12) == ["{", "  a = 1,", "  b = 2", "}"]


def test_a_fill_puts_as_many_items_on_a_line_as_fit() -> None:
    assert render(CALL, 14) == ["f(alpha, beta,", "  gamma)"]
    assert render(CALL, 13) == ["f(alpha,", "  beta,", "  gamma)"]


def test_what_follows_an_item_of_several_lines_begins_a_new_one() -> None:
    document = ("f(", Nest(2, Fill(listed([BLOCK, "x"]))), ");")
    assert render(document, 14) == ["f({", "    a = 1,", "    b = 2", "  },", "  x);"]


def test_what_follows_a_group_counts() -> None:
    document: Document = (Group(("a", LINE, "b")), ";")
    assert render(document, 4) == ["a b;"]
    assert render(document, 3) == ["a", "b;"]


def test_an_outer_group_is_broken_before_an_inner_one() -> None:
    inner: Document = Group(("b", LINE, "c"))
    assert render(Group(("aaa", LINE, inner)), 5) == ["aaa", "b c"]


def test_the_first_layout_is_taken_of_which_every_line_fits() -> None:
    below: Document = Nest(2, (LINE, Flat("value")))
    document = FirstThatFits((("x = ", Flat("value")), ("x =", below), "never"))
    assert render((document, ";"), 10) == ["x = value;"]
    assert render((document, ";"), 9) == ["x =", "  value;"]
    assert render((document, ";"), 7) == ["never;"]


def test_lines_begin_at_the_statement() -> None:
    assert render(BLOCK, 14, 4) == ["    {", "      a = 1,", "      b = 2", "    }"]
