"""Every refutation is a real run of the program; a trace that is not one is noticed."""

from __future__ import annotations

import pytest

from cspdiag.base import SourceFile
from cspdiag.base.record import replaced
from cspdiag.base.sources import read_source
from cspdiag.obligations import ProofObligations, proof_obligations
from cspdiag.proofs.counterexamples.counterexample import counterexample
from cspdiag.proofs.search import breadth_first
from cspdiag.proofs.verdict import Limits, Refuted
from cspdiag.verify.confirm import Verifier, replayed, trace_of
from cspdiag.verify.runs.trace import Trace, TraceStep, read_trace
from cspdiag.verify.systems import SystemCache
from tests.models.programs import MODELS
from tests.properties.drawing import draw_programs
from tests.support.verifying import answers_to

TABLE = str(MODELS / "dining" / "deadlock.csp")


@pytest.fixture(scope="module")
def table() -> tuple[ProofObligations, Trace]:
    """Three philosophers, and the trace to their deadlock."""
    obligations = proof_obligations(read_source(TABLE), read_source, settings={"seats": "3"})
    question = obligations.questions[0]
    verifier = Verifier(obligations, read_source, "breadth-first")
    answer = verifier.answer(question, Limits())
    assert answer.replayed
    return obligations, read_trace(trace_of(answer, {}))


def test_the_program_does_what_was_found(table: tuple[ProofObligations, Trace]) -> None:
    obligations, trace = table
    network = obligations.network("SymmetricTable")
    assert network is not None
    result = replayed(network, trace, read_source)
    assert result.succeeded
    communications = [step.channel for step in trace.steps if step.kind == "communication"]
    assert [channel for channel, _ in result.communications] == communications
    assert result.deadlock is not None
    assert len(result.deadlock.cycle) == 6


@pytest.mark.parametrize("changed", ["shortened", "exchanged", "unknown channel", "extended"])
def test_a_trace_that_the_program_does_not_follow_is_detected(
    table: tuple[ProofObligations, Trace], changed: str
) -> None:
    obligations, trace = table
    network = obligations.network("SymmetricTable")
    assert network is not None
    first, second, *others = trace.steps
    steps = {
        "shortened": tuple(trace.steps[:-1]),
        "exchanged": (second, first, *others),
        "unknown channel": (first, replaced(second, channel="SymmetricTable.nothing"), *others),
        "extended": (*trace.steps, second),
    }[changed]
    result = replayed(network, replaced(trace, steps=steps), read_source)
    assert not result.succeeded
    assert result.steps < len(trace.steps) + 1


PRIORITIES = """process Urgent {
  out ask : int

  composition { ask ! 1 }
}

process Later {
  out tell : int

  composition { tell ! 2 }
}

process Chooses {
  in ask, tell : int

  communication { var value : int }

  composition {
    ask ? value -> tell ? value
    []>
    tell ? value -> stop
  }
}

process All {
  communication {
    urgent  : Urgent
    chooses : Chooses
    later   : Later

    urgent.ask -> chooses.ask
    later.tell -> chooses.tell
  }

  composition { urgent ||> chooses ||> later }
}

assert All deadlock free
"""


def test_runs_that_priorities_exclude_are_not_refutations() -> None:
    """Without priorities `tell` may be chosen, and then everything stops; with them `ask` is always ready before."""
    (answer,) = answers_to({"case.csp": PRIORITIES})
    assert answer.outcome == "unknown"
    assert "`chooses` continues with `urgent.ask` before `later.tell`" in answer.reason
    (answer,) = answers_to({"case.csp": PRIORITIES.replace("||>", "||")})
    assert (answer.outcome, answer.replayed) == ("refuted", True)


COUNTED = """process Ping {
  in  reply : int
  out ask   : int

  communication {
    var value : int
    var count : int = 0
  }

  composition { mu (ask ! 1 ; reply ? value ; count := count + 1) until count == 1000 }
}

process Pong {
  in  ask   : int
  out reply : int

  communication { var value : int }

  composition { mu (ask ? value ; reply ! 2) }
}

process Both {
  communication {
    ping : Ping
    pong : Pong

    ping.ask   -> pong.ask
    pong.reply -> ping.reply
  }

  composition { ping || pong }
}

assert Both livelock free
"""


def test_a_counting_loop_is_not_endless() -> None:
    (answer,) = answers_to({"case.csp": COUNTED})
    assert answer.outcome == "unknown"
    assert "in each round, `ping.count` changes" in answer.reason
    (answer,) = answers_to({"case.csp": COUNTED.replace(" until count == 1000", "")})
    assert (answer.outcome, answer.replayed) == ("refuted", True)


def test_values_that_the_trace_leaves_open_are_searched_for() -> None:
    """Only the value 17 leads to the state in which nothing more happens; the text contains it."""
    text = """process Picky {
  in key : int

  communication { var value : int }

  composition { key ? value ; if value == 17 then stop }
}

assert Picky deadlock free
"""
    (answer,) = answers_to({"case.csp": text})
    assert (answer.outcome, answer.replayed) == ("refuted", True)


def test_refutations_of_random_programs_replay() -> None:
    """If nothing was left open, every trace that was found is one of the program, unless priorities or times exclude
    it.
    """
    replays = 0

    def read(path: str) -> SourceFile:
        raise FileNotFoundError(path)

    def look(text: str) -> None:
        nonlocal replays
        obligations = proof_obligations(SourceFile(name="random.csp", text=text), read)
        question = obligations.questions[0]
        system = SystemCache(obligations).of(question.process)
        verdict = breadth_first.deadlock_free(system, Limits(0.2, 100_000_000))
        if system.abstractions or not isinstance(verdict, Refuted):
            return
        found = counterexample(system, verdict, "deadlock", question.process)
        network = obligations.network(question.process)
        assert network is not None
        trace = _trace(found, question.process)
        replay = replayed(network, trace, read)
        # Proofs are about runs without an uncaught fault: what comes after one is not a counterexample.
        faults = (replay.divergence or "").startswith("it ends with Fault")
        assert replay.succeeded or replay.excluded or faults, (replay.divergence, text)
        replays += replay.succeeded

    for start in (100, 107, 109, 110, 112):
        draw_programs(look, 6, start, shrink=False)
    assert replays >= 3


def _trace(found: object, process: str) -> Trace:
    from cspdiag.proofs.counterexamples.encode import encoded
    from cspdiag.verify.runs.trace import trace_text

    return read_trace(trace_text(encoded(found), process, "", {}, []))  # type: ignore[arg-type]


KEPT = """process Gives {
  out y : int

  composition { y ! 1 ; y ! 2 }
}

process Takes {
  in y : int

  communication { var value : int = 0 }

  composition { y ? value }
}

process Fills {
  communication {
    gives : Gives
    takes : Takes
    var round : int = 0

    gives.y -> buffer 3 -> takes.y
  }

  composition { mu ((gives || takes) ; round := round + 1) until round == 4 }
}

assert Fills deadlock free
"""


def test_a_value_that_is_taken_from_a_buffer_writes_none() -> None:
    """Two values enter and one leaves in each repetition, so the writer waits forever in the last one."""
    (answer,) = answers_to({"case.csp": KEPT})
    assert (answer.outcome, answer.replayed) == ("refuted", True), answer.reason


SKIPS = """process Gives {
  out y : int

  composition { y ! 1 }
}

process Polls {
  in y : int

  communication { var value : int = 0 }

  composition { y ? value -> skip []> skip -> skip }
}

process Pair {
  communication {
    gives : Gives
    polls : Polls

    gives.y -> polls.y
  }

  composition { gives ||> polls }
}

assert Pair deadlock free
"""


def test_a_guard_that_is_always_ready_comes_after_what_a_more_urgent_process_offers() -> None:
    """The process with the higher priority has written before the other one checks; otherwise the writer may be too
    late.
    """
    (answer,) = answers_to({"case.csp": SKIPS})
    assert answer.outcome == "unknown"
    assert "`polls` prefers `gives.y` to `skip`" in answer.reason
    assert "priorities" in answer.reason
    for changed in (SKIPS.replace("||>", "||"), SKIPS.replace("gives ||> polls", "polls ||> gives")):
        (answer,) = answers_to({"case.csp": changed})
        assert (answer.outcome, answer.replayed) == ("refuted", True)


POLLED = """process Polls {
  out sent : int
  in  kept : int

  communication { var value : int = 0 }

  composition { sent ! 1 ; (kept ? value -> skip []> skip -> stop) }
}

process Keeps {
  in  sent : int
  out kept : int

  communication { var value : int = 0 }

  composition { kept ! 1 ; sent ? value }
}

process Both {
  communication {
    polls : Polls
    keeps : Keeps

    polls.sent -> keeps.sent
    keeps.kept -> buffer 1 -> polls.kept
  }

  composition { polls || keeps }
}

assert Both deadlock free
"""


def test_a_value_in_a_buffer_comes_before_a_guard_that_is_always_ready() -> None:
    (answer,) = answers_to({"case.csp": POLLED})
    assert answer.outcome == "unknown"
    assert "`polls` prefers `keeps.kept` to `skip`" in answer.reason
    (answer,) = answers_to({"case.csp": POLLED.replace("[]>", "[]")})
    assert (answer.outcome, answer.replayed) == ("refuted", True)


def test_independent_steps_may_be_reordered() -> None:
    """The value may enter the buffer after the other process has checked, whatever the order in which a proof reports
    it.
    """
    program = POLLED.replace("sent ! 1 ;", "").replace("; sent ? value", "").replace("  polls.sent -> keeps.sent\n", "")
    program = program.replace("  out sent : int\n", "").replace("  in  sent : int\n", "")
    obligations = proof_obligations(SourceFile(name="case.csp", text=program), read_source)
    network = obligations.network("Both")
    assert network is not None
    wrote = TraceStep("communication", "Both.keeps.kept", None, (("Both.keeps", "Both.keeps"),))
    checked = TraceStep("internal", "", None, (("Both.polls", "Both.polls"),))
    trace = Trace("Both", {}, "", "deadlock", (wrote, checked), (), (("Both.polls", frozenset()),), exact=True)
    assert replayed(network, trace, read_source).succeeded
