"""What an answer says about delays and computations, in the words of the text."""

from __future__ import annotations

from cspdiag.proofs.answers.text import render
from tests.support.verifying import answer_to

AT = """process Main {
  in x : double @ 5 ms
  communication { var v : double = 0
    var since : time = 0 s }
  composition { mu (at since + 333 ms -> since := now [] x ? v -> skip) }
}
assert Main livelock free
"""

ELEMENTS = """process Main {
  in x : int
  out o : int
  communication { var v : int = 0
    var a : int[4] = [0, 0, 0, 0]
    var i : int = 0 }
  composition { (mu (x ? v ; a[i] := v ; i := (i + 1) % 4 ; o ! a[i])) catch Fault -> stop }
}
assert Main deadlock free
"""


def test_a_guard_at_an_instant_is_reported_as_in_the_text() -> None:
    answer = answer_to(AT)
    assert answer.outcome == "unknown"
    assert "before `at since + 333 ms`, and proofs leave times out" in answer.reason
    assert [abstraction.what for abstraction in answer.abstractions] == [
        "`at since + 333 ms` in `Main` may be no time at all"
    ]


def test_what_may_end_in_a_fault_is_named_once() -> None:
    answer = answer_to(ELEMENTS)
    assert answer.outcome == "unknown"
    assert {abstraction.what for abstraction in answer.abstractions} == {"`a[i]` in `Main` may end in a fault or not"}
    assert len(answer.abstractions) == 2, "what is assigned, and what is written"
    listed = [
        line.strip()
        for line in render([answer], colour=False).splitlines()
        if "may end in a fault" in line and "(case.csp:7)" in line
    ]
    assert listed == ["`a[i]` in `Main` may end in a fault or not (case.csp:7)"]
