"""A copy is replaced by its original as long as both keep the value on all paths to the place."""

from __future__ import annotations

import pytest

from cspdiag.network.dump.action import action_lines
from cspdiag.network.ir.network import ProcessClass
from cspdiag.optimize import optimize, pass_named
from cspdiag.optimize.fuse.copies import without_copies
from tests.network import programs


def lines_of(composition: str) -> list[str]:
    """The composition between a first and a last communication, without copies."""
    network = programs.network(f"""
process Main {{
  in u : int
  out y : int
  communication {{ var a : int = 1  var b : int = 2  var c : int = 3  var n : int = 0 }}
  composition {{ u ? a ; c := n ; {composition} ; y ! a + b + c + n }}
}}
""")
    main = optimize(network, [pass_named("variables")]).class_named("Main")
    assert isinstance(main, ProcessClass)
    assert main.body is not None
    return [line.strip() for line in action_lines(without_copies(main.body))]


@pytest.mark.parametrize(
    ("composition", "expected"),
    [
        ("b := a ; y ! b", "a"),
        ("b := a ; c := b ; y ! c", "a"),
        ("b := a ; u ? a ; y ! b", "b"),
        ("b := a ; b := n ; y ! b", "n"),
        ("(if n > 0 then b := a else b := a) ; y ! b", "a"),
        ("(if n > 0 then b := a else u ? b) ; y ! b", "b"),
        ("b := a ; (if n > 0 then stop else u ? c) ; y ! b", "a"),
        ("b := a ; (if n > 0 then u ? a) ; y ! b", "b"),
        ("b := a ; mu (u ? c ; y ! b) until c > 3", "a"),
        ("b := a ; mu (y ! b ; u ? a) until c > 3", "b"),
        ("b := a ; mu (y ! b ; u ? a ; b := a) until c > 3", "a"),
        ("b := a ; c := a ; mu (y ! b ; b := c ; u ? c) until c > 3", "b"),
        ("b := a ; while n < 3 do (y ! b ; u ? n)", "a"),
        ("b := a ; while n < 3 do (y ! b ; u ? n ; b := n)", "b"),
        ("b := a ; seq i < 1000 : (y ! b ; u ? n)", "a"),
        ("b := a ; seq i < 1000 : (y ! b ; u ? a)", "b"),
        ("b := a ; (u ? c -> y ! b [] after 1 ms -> u ? a)", "a"),
        ("b := a ; (u ? a -> y ! b [] after 1 ms -> skip)", "b"),
        ("b := a ; ((u ? a ; u ? c) catch Timeout -> y ! b)", "b"),
        ("b := a ; (u ? c catch Timeout -> y ! b)", "a"),
    ],
)
def test_what_is_read(composition: str, expected: str) -> None:
    assert next(line for line in lines_of(composition) if line.startswith("y ! ")) == f"y ! {expected}"


def test_what_holds_after_a_loop_holds_in_its_condition() -> None:
    assert "repeat until a > 3" in lines_of("b := a ; mu (u ? a ; b := a) until b > 3")
