"""What continues forever was stepped through until everything was as before; a loop that may end was not."""

from __future__ import annotations

import pytest

from tests.support.verifying import answer_to

PROGRAM = """exception Over

process Main {{
  communication {{
    var n     : {type} = 0
    var a     : {type} = 0
    var b     : {type} = 0
    channel c : {type} sync
    channel d : {type} sync
  }}

  composition {{
    {composition}
  }}
}}

assert Main {claim}
"""

PAIR = "mu (c ! 1 ; wait 1 ms) || mu (c ? a)"

ENDING = [
    ("(mu ((mu (n := n + 1) until n >= 1) ; c ! 1)) || c ? a", "livelock free"),
    ("(c ! 1 || c ? a) ; mu (n := n + 1) until n == a", "livelock free"),
    ("(c ! 1 || c ? a) ; mu (n := n + 1) until n == a", "terminates"),
    ("(c ! 1 || c ? a) ; mu (if n > 2 then wait 1 ms ; n := n + 1) until n == 5", "terminates"),
    (f"({PAIR} || ((mu (wait 1 ms ; n := n + 1) until n >= 40) ; raise Over)) catch Over -> skip", "terminates"),
    ("(mu (c ! n ; n := n + 1)) || (mu (c ? a) until a > 100)", "livelock free"),
    ("(mu (wait 2 ms ; n := n - 1 ; a := 1 / (n + 3))) || mu wait 1 ms", "terminates"),
    ("(mu (c ! 1 ; n := n - 1 ; a := 1 / (n + 30))) || mu (c ? b)", "livelock free"),
    ("(mu (c ! 1 ; n := n - 1 ; a := 1 / (n + 30))) || mu (c ? b)", "terminates"),
    ("(mu (c ! 1 ; n := n - 1 ; a := n % (n + 30))) || mu (c ? b)", "livelock free"),
    ("(mu (c ! 1 ; n := 2 * n + 1)) || mu (c ? b)", "livelock free"),
    ("(mu (c ! n ; n := n - 1)) || mu (c ? b ; a := 1 / (b + 30))", "livelock free"),
]
"""What ends or halts because something is counted that proofs may not follow."""

ENDLESS = [
    ("(c ! 1 || c ? a) ; mu (skip -> n := a [] skip -> n := 2) until n > a", "livelock free"),
    ("(c ! 1 || c ? a) ; mu (skip -> n := a [] skip -> n := 2) until n > a", "terminates"),
    ("(mu (c ! n ; n := n + 1)) || mu (c ? a)", "livelock free"),
    ("(mu (n := 0 ; (mu (c ! n ; n := n + 1) until n >= 3))) || mu (c ? a)", "livelock free"),
    (f"{PAIR} || (mu (wait 1 ms ; n := 1 - n))", "terminates"),
    (f"{PAIR} || (mu (d ! n ; wait 2 ms ; n := n + 1)) || mu (d ? a)".replace("d ? a", "d ? b"), "terminates"),
    ("mu (skip -> skip [] skip -> n := 1) until n == 1", "livelock free"),
    ("mu (skip -> skip [] skip -> n := 1) until n == 1", "terminates"),
]


@pytest.mark.parametrize(("composition", "claim"), ENDING)
def test_a_loop_that_may_end_is_not_reported_as_endless(composition: str, claim: str) -> None:
    answer = answer_to(PROGRAM.format(type="int", composition=composition, claim=claim))
    assert answer.outcome != "refuted" or not answer.counterexample.cycle


@pytest.mark.parametrize(("composition", "claim"), ENDLESS)
def test_a_repetition_of_the_whole_state_is_endless(composition: str, claim: str) -> None:
    answer = answer_to(PROGRAM.format(type="int", composition=composition, claim=claim))
    assert (answer.outcome, answer.replayed) == ("refuted", True)
    assert answer.counterexample is not None
    assert answer.counterexample.cycle


def test_a_loop_that_only_computes_is_left_as_the_program_leaves_it() -> None:
    composition, claim = ENDING[0]
    answer = answer_to(PROGRAM.format(type="int", composition=composition, claim=claim))
    assert answer.outcome == "unknown"
    assert "only computes or abandons" in answer.reason


def test_a_law_whose_state_faults() -> None:
    law = "submodel Counts { out y : int  state s : int = 0  next s = s + 1  y = 1 / (30 - s) }\n\nprocess Main"
    composition, claim = "(mu (c ! 1 ; counts)) || mu (c ? a)", "livelock free"
    text = PROGRAM.format(type="int", composition=composition, claim=claim).replace("process Main", law)
    text = text.replace("    channel d : int sync", "    counts : Counts\n    counts.y -> _")
    assert answer_to(text).outcome == "unknown"
    assert answer_to(text.replace("1 / (30 - s)", "s")).outcome == "refuted"


def test_a_counter_of_few_bits_ends_in_a_fault() -> None:
    text = PROGRAM.format(type="int8", composition=ENDLESS[2][0], claim=ENDLESS[2][1])
    assert answer_to(text).outcome == "unknown"
