"""Sums of 64-bit integers and times that overflow, inside a ``catch Fault``: only what counts by small steps is taken
not to overflow.
"""

from __future__ import annotations

import pytest

from tests.support.verifying import answer_to

PROGRAM = """process Main {{
  {ports}
  out beat : int
  communication {{
    var n : int = 5
    var m : int = 7
    var t : time = 2 ms
    var u : time = 0 ms
    {parts}
  }}
  composition {{ {composition} }}
}}
{more}
assert Main deadlock free
"""

RELAY = """process Counter {
  out c : int
  communication { var k : int = START }
  composition { mu (c ! k ; k := NEXT) }
}
process Follower {
  in c : int
  out beat : int
  communication { var k : int = 0 }
  composition { mu (c ? k ; beat ! 1 ; ((k := k + 1) catch Fault -> stop)) }
}
"""
TOGETHER = "a : Counter\n b : Follower\n a.c -> b.c\n b.beat -> beat"

OVERFLOWS = {
    "a large constant": "beat ! 1 ; ((n := n + 9223372036854775807) catch Fault -> stop)",
    "below zero": "beat ! 1 ; ((n := -9223372036854775807 - n) catch Fault -> stop)",
    "the negative of the smallest": "beat ! 1 ; m := -9223372036854775807 - 1 ; ((n := -m) catch Fault -> stop)",
    "a large start": "n := 9223372036854775807 ; beat ! 1 ; ((n := n + 1) catch Fault -> stop)",
    "what is doubled": "(mu (wait 1 ms ; beat ! n ; n := n + n)) catch Fault -> stop",
    "two that are added to each other": "(mu (wait 1 ms ; beat ! n ; n := n + m ; m := m + n)) catch Fault -> stop",
    "steps that grow": "(mu (wait 1 ms ; beat ! n ; n := n + m ; m := m * 10)) catch Fault -> stop",
    "a large step": "(mu (wait 1 ms ; beat ! n ; n := n + 1000000000000000000)) catch Fault -> stop",
    "a time": "beat ! 1 ; ((wait t + 9223372036 s + 854 ms) catch Fault -> stop)",
    "times that are doubled": "(mu (wait 1 ms ; beat ! 1 ; t := t + t)) catch Fault -> stop",
    "an instant": "beat ! 1 ; ((wait until now + t + 9223372036 s + 854 ms) catch Fault -> stop)",
    "the size of a time": "t := -9223372036854775807 ns - 1 ns ; beat ! 1 ; ((wait abs(t)) catch Fault -> stop)",
    "a guard": "beat ! 1 ; ((when n + 9223372036854775807 > 0 & beat ! 2 -> skip) catch Fault -> stop)",
}

COUNTS = {
    "a counter": "mu (wait 1 ms ; beat ! n ; ((n := n + 1) catch Fault -> stop))",
    "a counter down": "mu (wait 1 ms ; beat ! n ; ((n := n - 1000) catch Fault -> stop))",
    "one of two": "mu (wait 1 ms ; beat ! n ; ((m := n + 1 ; n := if m > 3 then m else 0) catch Fault -> stop))",
    "a sum of two counters": "mu (wait 1 ms ; beat ! n ;"
    " ((n := n + 1 ; m := m + 2 ; beat ! n + m) catch Fault -> stop))",
    "a remainder": "mu (wait 1 ms ; beat ! n ; ((n := (n + m) % 10) catch Fault -> stop))",
    "a beat": "t := now ; mu (wait 1 ms ; beat ! 1 ;"
    " ((u := now - t ; t := t + 10 ms ; wait until t) catch Fault -> stop))",
}


def program(composition: str, **other: str) -> str:
    given = {"ports": "", "parts": "", "more": "", **other}
    return PROGRAM.format(composition=composition, **given)


@pytest.mark.parametrize("name", OVERFLOWS)
def test_overflow_that_is_caught_is_found(name: str) -> None:
    assert answer_to(program(OVERFLOWS[name])).outcome == "refuted"


def test_present_time_is_not_near_zero_after_a_long_delay() -> None:
    composition = "wait 9000000000 s ; beat ! 1 ; ((u := now + 500000000 s) catch Fault -> stop)"
    assert answer_to(program(composition)).outcome != "proved"
    assert answer_to(program(composition.replace("9000000000", "9"))).outcome == "proved"


@pytest.mark.parametrize("name", COUNTS)
def test_what_counts_by_little_does_not_overflow(name: str) -> None:
    assert answer_to(program(COUNTS[name])).outcome == "proved"


@pytest.mark.parametrize("name", COUNTS)
def test_what_counts_from_an_input_may_overflow(name: str) -> None:
    """The environment may give any integer, and any duration; a remainder is small, whatever its dividend, but the
    dividend need not be.
    """
    first = "e ? n -> f ? t ; m := n" if name != "a beat" else "f ? t -> t := t"
    composition = f"({first}) ; {COUNTS[name].replace('t := now ; ', '')}"
    assert answer_to(program(composition, ports="in e : int\n in f : time")).outcome == "refuted"


@pytest.mark.parametrize(
    ("start", "following", "verdict"),
    [("0", "k + 1", "proved"), ("0", "k + k + 1", "unknown"), ("9223372036854775807", "k", "refuted")],
)
def test_values_are_followed_through_channels(start: str, following: str, verdict: str) -> None:
    more = RELAY.replace("START", start).replace("NEXT", following)
    assert answer_to(program("a || b", parts=TOGETHER, more=more)).outcome == verdict


CONDITIONS = {
    "an if": "(if v - 1 != 7 then skip) catch Fault -> stop",
    "a guard": "((when v + 1 > 7 & skip -> skip) [] skip -> skip) catch Fault -> stop",
    "a loop": "(while v + 1 > 7 do v := 0) catch Fault -> stop",
    "both of two": "(if v > 3 and v + 1 > 7 then skip) catch Fault -> stop",
}


@pytest.mark.parametrize("name", CONDITIONS)
def test_a_condition_that_holds_for_a_whole_range_may_overflow_in_it(name: str) -> None:
    text = (
        "process Main { in i : int communication { var v : int = 0 }"
        f" composition {{ i ? v ; ({CONDITIONS[name]}) }} }}\nassert Main deadlock free\n"
    )
    assert answer_to(text).outcome == "refuted"


SPECIFICATION = """process Main {{
  in i : int
  out o : int
  communication {{ var v : int = 0 }}
  composition {{ i ? v ; o ! 128 }}
}}

process Spec {{
  in i : int
  out o : int
  communication {{ var v : int = 0  var b : int8 = -128 }}
  composition {{ i ? v ; ({computes}) }}
}}

assert Main refines Spec
"""


@pytest.mark.parametrize(
    ("computes", "outcomes"),
    [
        ("(if v - 1 != 7 then skip) ; o ! 128", {"unknown", "refuted"}),
        ("(o ! int(-b)) catch Fault -> skip", {"refuted"}),
        ("((o ! int(-b)) catch Fault -> skip) ; o ! 128", {"proved"}),
    ],
)
def test_a_specification_may_overflow(computes: str, outcomes: set[str]) -> None:
    assert answer_to(SPECIFICATION.format(computes=computes)).outcome in outcomes
