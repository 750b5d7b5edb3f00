"""Delays of zero or negative duration, which end immediately: loops of them let no time pass."""

from __future__ import annotations

import pytest

from tests.support.verifying import answer_to

PROGRAM = """const NONE = 0 ms
exception Odd

process Main{parameters} {{
  in e : int
  in f : time
  in x : double @ 10 ms

  communication {{
    var v : int = 0
    var q : bool = false
    var a : double = 0
    var d : time = {initial}
    {parts}
  }}

  composition {{
    {composition}
  }}
}}

{more}
assert Main {claim}
"""

OVER_AT_ONCE = {
    "a wait": ("mu (wait 0 ms ; q := false) until q", {}),
    "a difference": ("mu (wait 1 ms - 1 ms ; q := false) until q", {}),
    "a constant": ("mu (e ? v -> wait 1 ms [] after NONE -> skip)", {}),
    "a time-out with less priority": ("mu (e ? v -> wait 1 ms []> after 0 ms -> skip)", {}),
    "a variable": ("mu (e ? v -> skip []> after d -> skip)", {"initial": "-1 ms"}),
    "a variable that is read": ("f ? d ; mu (wait d)", {}),
    "a parameter": ("mu (wait p ; q := false) until q", {"parameters": "(p : time = 0 ms)"}),
    "a product": ("mu (wait 1 ms * p ; q := false) until q", {"parameters": "(p : int = 0)"}),
    "a branch in parallel with others": ("(mu (x ? a)) || (mu (wait 0 ms ; q := false) until q)", {}),
    "one of several that spin": (
        "(mu wait d) || (mu (x ? a)) || (mu (wait NONE ; q := false) until q)",
        {"initial": "-1 ms"},
    ),
    "the time-out of an interrupt": ("mu (((x ? a) interrupt after 0 ms -> skip) ; q := false) until q", {}),
    "an instance of several": (
        "long || short",
        {
            "parts": "long : Waits(1 ms)  short : Waits(0 ms)",
            "more": "process Waits(p : time) { composition { mu wait p } }",
        },
    ),
    "an instance whose time-out is over at once": (
        "long || short",
        {
            "parts": "long : Waits(1 ms)  short : Waits(0 ms)",
            "more": "process Waits(p : time) { composition { mu (after 2 * p -> skip []> after 1 s -> skip) } }",
        },
    ),
    "an instance inside others": (
        "long || short",
        {
            "parts": "long : Twice(1 ms)  short : Twice(0 ms)",
            "more": "process Twice(p : time) { communication { one : Waits(2 * p) } composition { one } }\n"
            "process Waits(p : time) { composition { mu wait p } }",
        },
    ),
    "a delay that is abandoned": ("mu (((wait 5 ms) interrupt skip -> skip) ; q := false) until q", {}),
    "a delay abandoned by a guard of its own": (
        "mu (((wait 5 ms) interrupt skip -> wait 0 ms) ; q := false) until q",
        {},
    ),
    "a delay in nested interrupts": (
        "mu ((((wait 5 ms) interrupt after 1 ms -> skip) interrupt skip -> skip) ; q := false) until q",
        {},
    ),
    "a delay abandoned for a write that never waits": (
        "(mu (((wait 5 ms) interrupt c ! 1 -> skip) ; q := false) until q) || c ? v",
        {"parts": "channel c : int overwrite 1"},
    ),
    "one of two paths": ("mu (if v > 3 then wait 1 ms else wait d)", {"initial": "0 ms"}),
}
"""Loops that continue while no time passes, in some instances, or with something that may end them: others are refused
by the compiler.
"""

MAY_BE_OVER = {
    "a variable that is counted down": ("mu (wait d ; d := d - 1 ms)", {"initial": "4 ms"}),
    "a difference of variables": ("mu (wait d - 4 ms ; d := d + 1 ms)", {"initial": "5 ms"}),
}
"""Delays that let time pass at first."""

LASTS = {
    "a wait": ("mu wait 1 ns", {}),
    "a constant less another": ("mu wait 2 ms - 1 ms", {}),
    "a time-out": ("mu (e ? v -> skip [] after NONE + 1 ms -> skip)", {}),
    "a variable that never changes": ("mu wait d", {"initial": "4 ms"}),
    "a variable that only grows": ("mu (wait d ; d := d + 1 ms)", {"initial": "4 ms"}),
    "a variable with two values": ("mu (wait d - 1 ms ; d := 3 ms)", {"initial": "4 ms"}),
    "a parameter": ("mu wait 2 * p", {"parameters": "(p : time = 1 ms)"}),
    "instances one after the other": (
        "mu (long ; short)",
        {
            "parts": "long : Waits(1 ms)  short : Waits(0 ms)",
            "more": "process Waits(p : time) { composition { wait p } }",
        },
    ),
    "instances": (
        "long || short",
        {
            "parts": "long : Waits(3 ms)  short : Waits(2 ms)",
            "more": "process Waits(p : time) { composition { mu wait p - 1 ms } }",
        },
    ),
    "what is known at its place": ("f ? d ; mu (if d > 2 ms then wait d else wait 1 ms)", {}),
    "the greater of two": ("f ? d ; mu wait max(d, 1 ms)", {}),
    "one of two durations": ("mu wait (if v > 3 then 1 ms else 2 ms)", {}),
    "a sample": ("mu (wait 0 ms ; x ? a)", {}),
    "the time-out of an interrupt": ("mu ((stop) interrupt after 1 ms -> skip)", {}),
    "what is abandoned before it communicates": (
        "(mu ((c ! 1) interrupt skip -> wait 1 ms)) || mu (c ? v)",
        {"parts": "channel c : int sync"},
    ),
}
"""Loops in which time passes in each iteration."""


def answer(case: tuple[str, dict[str, str]], claim: str = "livelock free") -> str:
    composition, given = case
    blanks = {"parameters": "", "initial": "1 ms", "parts": "", "more": "", "claim": claim}
    found = answer_to(PROGRAM.format(composition=composition, **{**blanks, **given}))
    assert found.replayed == (found.outcome == "refuted"), found.reason
    return f"{found.outcome} {found.reason}"


@pytest.mark.parametrize("name", OVER_AT_ONCE)
def test_a_loop_of_delays_that_are_over_at_once_is_refuted(name: str) -> None:
    assert answer(OVER_AT_ONCE[name]).startswith("refuted")


@pytest.mark.parametrize("name", ["an instance of several", "a delay that is abandoned"])
def test_a_loop_that_lets_no_time_pass_does_not_end(name: str) -> None:
    assert answer(OVER_AT_ONCE[name], "terminates").startswith("refuted")


@pytest.mark.parametrize("name", MAY_BE_OVER)
def test_a_delay_that_may_be_over_at_once_is_not_proved_to_let_time_pass(name: str) -> None:
    found = answer(MAY_BE_OVER[name])
    assert found.startswith("unknown")
    assert "may be no time at all" in found


@pytest.mark.parametrize("name", LASTS)
def test_a_delay_that_surely_takes_time_is_proved_to(name: str) -> None:
    assert answer(LASTS[name]).startswith("proved")
