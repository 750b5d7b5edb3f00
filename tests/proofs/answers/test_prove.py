"""Assertions and the answers to them."""

from __future__ import annotations

import pytest

from cspdiag.base import SourceFile, Span
from cspdiag.proofs import portfolio
from cspdiag.proofs.answers.prove import prove
from cspdiag.proofs.answers.question import Question
from cspdiag.proofs.verdict import Limits
from tests.proofs.systems import known
from tests.support.verifying import answers_to

SPAN = Span(SourceFile(name="a.csp", text="assert P deadlock free"), 0, 22)


def test_exhausted_memory_gives_no_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    def exhausted(*_: object) -> None:
        raise MemoryError

    monkeypatch.setattr(portfolio, "prove_deadlock_free", exhausted)
    answer = prove(Question("P", "deadlock free", SPAN), lambda _: known.philosophers(3), Limits())
    assert (answer.outcome, answer.reason) == ("unknown", "the memory of this machine is used up")


def test_a_knot_next_to_running_processes_is_distinguished_from_a_deadlock() -> None:
    question = Question("P", "deadlock free", SPAN)
    deadlock = prove(question, lambda _: known.philosophers(3), Limits())
    knot = prove(question, lambda _: known.with_loop(known.philosophers(3)), Limits())
    assert deadlock.counterexample is not None
    assert knot.counterexample is not None
    assert (deadlock.counterexample.failure, knot.counterexample.failure) == ("deadlock", "knot")
    assert len(deadlock.counterexample.ring) == len(knot.counterexample.ring) == 6
    assert [entry.name for entry in knot.counterexample.waiting] == [e.name for e in deadlock.counterexample.waiting]


def test_the_text_of_a_question_is_that_of_the_language() -> None:
    refines = Question("P", "refines", SPAN, specification="Q", model="failures", hidden=("a", "b"))
    assert refines.text == "P refines Q in failures hide a, b"
    assert refines.processes == ("P", "Q")


STOPPED = """
process Axis {
  in stop : bool

  communication { var stopped : bool = false }

  composition { mu stop ? stopped until stopped }
}

process Axes {
  in stop[2] : bool

  communication {
    axis[2] : Axis

    for i < 2 {
      stop[i] -> axis[i].stop
    }
  }

  composition { par i < 2 : axis[i] }
}

assert Axes deadlock free
"""


def test_a_branch_that_ends_with_others_does_not_wait_for_them() -> None:
    (answer,) = answers_to({"case.csp": STOPPED})
    assert answer.outcome == "proved"
    assert answer.reason == "no deadlock and no knot (no process ever waits for another)"
