"""The line numbers in the rows of a run that is shown for a counterexample are those that the run executed."""

from __future__ import annotations

from tests.support.verifying import answer_to

LOOP = """exception Odd
process P {
  out a : int
  communication { var n : int = 0 }
  composition {
    ((seq i < 300 : (a ! n ; n := n + 1 ; (if n == 70 then raise Odd))) catch Odd -> a ! -1) ;
    a ! n ;
    stop
  }
}
process Q { in a : int communication { var v : int = 0 } composition { mu (a ? v) } }
process Main { communication { p : P q : Q p.a -> a : int -> q.a } composition { p || q } }
assert Main deadlock free
"""
"""The proof leaves `n` open: after each iteration there is the next one, the exception, or the end of the loop."""


def test_rows_have_the_lines_at_which_the_run_was() -> None:
    answer = answer_to(LOOP)
    assert answer.replayed
    assert answer.counterexample is not None
    lines = [
        party.span.line
        for step in answer.counterexample.steps
        for party in step.parties
        if step.shown and party.name == "p" and party.span is not None
    ]
    assert lines == [6] * 71 + [7]
