"""The time limit applies to an entire answer, and a replay that does not end by itself is ended."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.obligations import proof_obligations
from cspdiag.proofs.verdict import Limits
from cspdiag.verify import suggest
from cspdiag.verify.alarm import ended_by_alarm
from cspdiag.verify.confirm import Verifier, replayed
from cspdiag.verify.replay import attempt, attempts
from cspdiag.verify.runs.trace import Trace

ENDLESS = """process Writes {
  out c : int

  composition { mu (c ! 1) }
}

process Reads {
  in c : int

  communication { var x : int = 0 }

  composition { mu (c ? x) }
}

process Both {
  communication {
    writes : Writes
    reads  : Reads

    writes.c -> reads.c
  }

  composition { writes || reads }
}
"""


def read(path: str) -> SourceFile:
    raise FileNotFoundError(path)


def test_a_replay_that_never_comes_to_rest_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    """The trace says that two processes are stuck which communicate forever."""
    monkeypatch.setattr(attempt, "_MOST_TURNS", 20)
    built = pipeline.build(SourceFile(name="case.csp", text=ENDLESS), read)
    assert built.network is not None
    channel = frozenset({"Both.writes.c"})
    stuck = (("Both.writes", channel), ("Both.reads", channel))
    trace = Trace("Both", {}, "Both deadlock free", "deadlock", (), (), stuck, exact=True)
    assert replayed(built.network, trace, read).divergence == "it runs on and on, and never comes to rest"


STUCK = ENDLESS.replace("mu (c ! 1)", "c ! 1 ; c ! 1").replace("mu (c ? x)", "c ? x") + "\nassert Both deadlock free\n"


@pytest.mark.parametrize("where", ["replay", "suggestions"])
def test_the_limit_covers_everything(where: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """What never ends by itself is ended from outside, wherever it is."""
    obligations = proof_obligations(SourceFile(name="case.csp", text=STUCK), read)
    entered = []

    def endless(*_: object, **__: object) -> None:
        entered.append(where)
        while True:
            pass

    if where == "replay":
        monkeypatch.setattr(attempts, "replay", endless)
    else:
        monkeypatch.setattr(suggest, "suggestions", endless)
    answer = Verifier(obligations, read, enforced=ended_by_alarm).answer(obligations.questions[0], Limits(1.0))
    assert entered == [where]
    assert answer.outcome == ("unknown" if where == "replay" else "refuted")
    assert not answer.suggestions
    if where == "replay":
        assert answer.reason == "a counterexample was found, but it was not replayed: the time limit of 1 s was reached"


def test_what_is_limited_includes_the_transition_system() -> None:
    obligations = proof_obligations(SourceFile(name="case.csp", text=STUCK), read)

    @contextmanager
    def at_once(limits: Limits) -> Iterator[None]:
        raise limits.time_is_up()
        yield

    answer = Verifier(obligations, read, enforced=at_once).answer(obligations.questions[0], Limits(1.0))
    assert (answer.outcome, answer.reason) == ("unknown", "the time limit of 1 s was reached")
