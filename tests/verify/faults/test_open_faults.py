"""Faults that a proof leaves open: they end a program, and whatever is stuck in it."""

from __future__ import annotations

import pytest

from tests.support.verifying import answer_to

KNOT = """process Main {{
  communication {{
    var v : int = 0
    var w : int = 0
    var x : int = 0
    var z : int = 0
    channel c : int
    channel d : int
  }}

  composition {{ (c ? v ; d ! 3) || (d ? w ; c ! 3) || mu (wait 1 ms ; {beside}) }}
}}

assert Main terminates
"""


@pytest.mark.parametrize(
    ("beside", "allowed"),
    [
        ("z := 6 / (if now >= 3 ms then 0 else 1)", {"proved", "unknown"}),
        ("z := z - 1 ; x := 6 / (z + 3)", {"proved", "unknown"}),
        ("z := z - 1", {"refuted"}),
    ],
)
def test_a_fault_may_end_a_program_in_which_some_are_stuck(beside: str, allowed: set[str]) -> None:
    assert answer_to(KNOT.format(beside=beside)).outcome in allowed


def test_a_missed_sample_may_end_a_program_in_which_some_are_stuck() -> None:
    text = KNOT.format(beside="sampled ? x ; wait 5 ms").replace(
        "process Main {\n", "process Main {\n  in sampled : int @ 2 ms\n"
    )
    assert answer_to(text).outcome != "refuted"


def test_a_specification_fails_only_where_what_it_computes_does() -> None:
    answer = answer_to("""process Spec {
  out o : int

  communication { var v : int = 1 }

  composition { (o ! (if now >= 3 ms then 6 / (v - 1) else 2)) catch Fault -> stop }
}

process Main {
  out o : int

  composition { o ! 2 }
}

assert Main refines Spec
""")
    assert answer.outcome != "refuted"
