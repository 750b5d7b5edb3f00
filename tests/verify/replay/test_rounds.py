"""Counterexamples that go through loops whose end is computed: the program iterates until it is where the
counterexample has it.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from cspdiag.verify.replay import rounds
from tests.cli.conftest import Command, cspdiag  # noqa: F401 - a fixture
from tests.support.verifying import answers_to

OVEN = """submodel Warm(samples: int) {
  in  heat : double
  out hot  : bool

  state count : int = 0

  let now = if CONDITION then count + 1 else 0
  next count = now
  hot = now >= samples
}

process Heater {
  in heat : double @ 10 ms
  in go   : bool

  communication {
    warm : Warm(samples = SAMPLES)
    var ready : bool = false

    heat     -> warm.heat
    warm.hot -> hot : bool
  }

  composition { (mu warm until hot) ; go ? ready ; stop }
}

process Starter {
  out go : bool

  composition { go ! true ; wait 1 s }
}

process Oven {
  in heat : double @ 10 ms

  communication {
    heater  : Heater
    starter : Starter

    heat       -> heater.heat
    starter.go -> heater.go
  }

  composition { heater || starter }
}

assert Oven deadlock free
"""


@pytest.fixture(autouse=True)
def few_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rounds, "MOST_STEPS", 200)
    monkeypatch.setattr(rounds, "MOST_IN_ALL", 1_200)


def oven(condition: str = "heat < 0.5", samples: int = 25) -> str:
    return OVEN.replace("CONDITION", condition).replace("SAMPLES", str(samples))


@pytest.mark.parametrize(
    ("condition", "value"), [("heat < 0.5", "0.0"), ("heat > 0.5", "1.0"), ("heat > 36.5 and heat < 37.5", "37.0")]
)
def test_a_process_loops_until_its_law_ends_it(condition: str, value: str) -> None:
    (answer,) = answers_to({"case.csp": oven(condition)})
    assert (answer.outcome, answer.replayed) == ("refuted", True)
    assert answer.counterexample is not None
    added = [step for step in answer.counterexample.steps if step.added]
    assert {(step.kind, step.channel, step.value) for step in added} == {("sample", "Oven.heat", value)}
    assert len(added) in (24, 25), "with the sample of the trace, of which the value is open, all that the law counts"
    assert all(party.span is not None for step in added for party in step.parties)


def test_an_endless_loop_is_not_followed_forever() -> None:
    (answer,) = answers_to({"case.csp": oven(samples=100_000_000)})
    assert answer.outcome == "unknown"
    assert "`heater` goes round" in answer.reason


def test_rounds_are_reported_and_stored_once(cspdiag: Command, tmp_path: Path) -> None:  # noqa: F811
    (tmp_path / "case.csp").write_text(oven())
    file, trace = str(tmp_path / "case.csp"), tmp_path / "trace.json"
    reported = cspdiag("verify", file, "--trace-out", str(trace)).err
    assert (
        "     1  sample heat 0.0           ?24\n  2-24  23 more rounds, heat 0.0  ?24\n    25  sample heat" in reported
    )
    assert "after 27 steps" in reported
    (entry,) = (step for step in json.loads(trace.read_text())["steps"] if step["kind"] == "rounds")
    assert (entry["times"], [step["channel"] for step in entry["steps"]]) == (24, ["Oven.heat"])
    replay = cspdiag("run", file, "--replay", str(trace))
    assert replay.code == 0
    assert replay.err.count("  heat  0.0\n") == 25
    assert "replayed: the program did all" in replay.err


FOLLOWS = """process Follows {
  in  speed : double @ 10 ms
  in  press : bool
  out done  : bool

  communication {
    warm : Warm(samples = 25)
    var pressed : bool = false

    speed    -> warm.heat
    warm.hot -> hot : bool
  }

  composition { (mu warm until hot) ; press ? pressed ; done ! true }
}

process NeverDone {
  in  speed : double
  in  press : bool
  out done  : bool

  communication {
    var value   : double = 0
    var pressed : bool   = false
    var over    : bool   = false
  }

  composition {
    mu (
      speed ? value -> skip
      []
      press ? pressed -> skip
      []
      when over & done ! true -> skip
      []
      skip -> over := true
    ) until over
  }
}
"""


@pytest.mark.parametrize(
    ("change", "hidden", "reason"),
    [
        ("", "", "it does `done"),
        ("speed ? value", " hide speed", "it does `done"),
        ("press ? pressed", "", "it does `press`"),
    ],
)
def test_specification_judges_the_run_with_its_rounds(change: str, hidden: str, reason: str) -> None:
    """It allows any number of samples; without one of its guards it does not see that port, or forbids it."""
    text = OVEN[: OVEN.index("process Heater")].replace("CONDITION", "heat < 0.5") + FOLLOWS
    if hidden:
        head, tail = text.split("process NeverDone")
        tail = tail.replace("  in  speed : double\n", "").replace("    var value   : double = 0\n", "")
        text = f"{head}process NeverDone{tail}".replace("      speed ? value -> skip\n      []\n", "")
    elif change:
        text = text.replace(f"      {change} -> skip", f"      when over & {change} -> skip")
    (answer,) = answers_to({"case.csp": f"{text}assert Follows refines NeverDone{hidden}\n"})
    assert answer.outcome == "refuted", answer.reason
    assert answer.counterexample is not None
    assert answer.counterexample.reason.startswith(reason)
    assert sum(step.channel == "Follows.speed" for step in answer.counterexample.steps) == 25


def test_rounds_of_the_trace_itself_have_a_row(cspdiag: Command, tmp_path: Path) -> None:  # noqa: F811
    text = """
process Counter { out a : int composition { (seq i < 60 : a ! i) ; stop } }
process Reader { in a : int communication { var v : int } composition { mu (a ? v) } }
process Main { communication { c : Counter r : Reader c.a -> a : int -> r.a } composition { c || r } }
assert Main deadlock free
"""
    (tmp_path / "case.csp").write_text(text)
    reported = cspdiag("verify", str(tmp_path / "case.csp")).err
    assert "after 60 steps" in reported
    assert "  2-59  58 more rounds, a 1 … 58  !2  ?3" in reported


SAME_VALUES = """
process Count {
  out o : int
  communication { var n : int = 0 }
  composition {
    (mu (
      o ! n ;
      n := n + 1
    ) until n == 70) ;
    o ! 3 ;
    o ! 5 ;
    stop
  }
}
assert Count deadlock free
assert Count terminates
"""


def test_a_value_that_a_later_statement_writes_too_stands_at_the_line_that_wrote_it() -> None:
    for answer in answers_to({"case.csp": SAME_VALUES}):
        assert (answer.outcome, answer.replayed) == ("refuted", True)
        assert answer.counterexample is not None
        written = [step for step in answer.counterexample.steps if step.channel == "Count.o"]
        assert [step.value for step in written] == [*map(str, range(70)), "3", "5"]
        lines = [party.span and party.span.line for step in written for party in step.parties]
        assert lines == [7] * 70 + [10, 11]
