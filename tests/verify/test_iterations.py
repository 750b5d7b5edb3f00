"""What is proved of a replicated ``seq`` that computes with its index: with few iterations it is unrolled, with many it
is a loop.
"""

from __future__ import annotations

import pytest

from cspdiag.network.elaborate.counted_loops import MOST_UNROLLED
from tests.support.verifying import answer_to

PROGRAM = """
process Left {{
  out c    : int
  out beat : int
  communication {{ var n : int = 0 }}
  composition {{ {left} }}
}}
process Right {{
  in c : int
  communication {{ var v : int = 0 }}
  composition {{ {right} }}
}}
process Main {{
  out beat : int
  communication {{
    left  : Left
    right : Right
    left.c    -> right.c
    left.beat -> beat
  }}
  composition {{ left || right }}
}}
assert Main {claim}
"""
READS = "seq k < {turns} : (c ? v ; wait v * 1 us)"
PARTNERS = {
    "as many": ("seq i < {turns} : c ! i", READS, "proved"),
    "one more": ("seq i < {turns} : c ! i ; c ! 0", READS, "refuted"),
    "no fault in range": ("(seq i < {turns} : c ! i * i + 1) catch Fault -> stop", READS, "proved"),
    "a fault in the middle": ("(seq i < {turns} : c ! 100 / (i - 50)) catch Fault -> stop", READS, "refuted"),
    "a fault in no iteration": ("(seq i < {turns} : c ! int(int8(i))) catch Fault -> stop", READS, "proved"),
    "a condition in the middle": ("seq i < {turns} : if i != 30 then c ! i", READS, "refuted"),
    "a condition on both sides": (
        "seq i < {turns} : (if i < 30 then c ! i else beat ! i)",
        "seq k < {turns} : if k < 30 then c ? v else skip",
        "proved",
    ),
    "a sequence in another": ("seq i < 2 : (seq k < {turns} : c ! i + k)", f"({READS}) ; ({READS})", "proved"),
}


@pytest.mark.parametrize("turns", [MOST_UNROLLED, MOST_UNROLLED + 1])
@pytest.mark.parametrize("name", PARTNERS)
def test_iterations_with_a_partner(name: str, turns: int) -> None:
    left, right, expected = (part.format(turns=turns) for part in PARTNERS[name])
    assert answer_to(PROGRAM.format(left=left, right=right, claim="deadlock free")).outcome == expected


@pytest.mark.parametrize("turns", [MOST_UNROLLED, 200])
def test_iterations_end(turns: int) -> None:
    left = f"(seq i < {turns} : (n := n + i ; c ! i)) ; beat ! n"
    text = PROGRAM.format(left=left, right=READS.format(turns=turns), claim="terminates")
    assert answer_to(text).outcome == "proved"


SAMPLED = """
process Main {{
  in  x    : int @ 1 ms
  out beat : int
  communication {{ var v : int = 0 }}
  composition {{ (seq i < {turns} : (x ? v ; {step} ; beat ! i)) }}
}}
assert Main schedulable
"""


@pytest.mark.parametrize(
    ("turns", "step", "allowed"),
    [
        (MOST_UNROLLED, "wait i % 4 * 100 us", {"proved"}),
        (66, "(wait 100 us ; v := v / (i + 1))", {"proved"}),
        (66, "wait i % 4 * 100 us", {"proved", "unknown"}),
        (MOST_UNROLLED, "wait i % 4 * 500 us", {"refuted", "unknown"}),
        (66, "wait i % 4 * 500 us", {"refuted", "unknown"}),
    ],
)
def test_iterations_that_keep_a_period(turns: int, step: str, allowed: set[str]) -> None:
    assert answer_to(SAMPLED.format(turns=turns, step=step)).outcome in allowed
