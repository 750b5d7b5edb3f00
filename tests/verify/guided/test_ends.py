"""A refutation is a real run of the program: it continues forever, halts, or refuses something."""

from __future__ import annotations

from pathlib import Path

import pytest

from cspdiag.cli.main import main
from cspdiag.proofs.counterexamples.counterexample import Step
from cspdiag.proofs.counterexamples.words import headline
from tests.support.verifying import answer_to, refuted
from tests.verify.guided.test_guided import RACE

REFUSES = """process Lamp {
  in  pressed : bool
  out light   : bool

  communication { var on : bool = false }

  composition { mu (pressed ? on ; light ! on) }
}

process Patient {
  in  pressed : bool
  out light   : bool

  communication { var on : bool = false }

  composition { mu (pressed ? on ; pressed ? on ; light ! on) }
}

assert Lamp refines Patient in failures
"""


def test_what_a_process_refuses_is_seen_before_it_continues() -> None:
    """After the first press the specification expects another one; the lamp is lit at once."""
    assert refuted(REFUSES)


TURNS = """process Cell {
  out number : int

  communication { var n : int = 0 }

  composition { while n < 3 do (number ! n ; n := n + 1 ; wait 2 ms) }
}

process Collector {
  in  number[2] : int
  out sum       : int

  communication { var got : int = 0  var last : int = 0 }

  composition { mu ((alt i < 2 : number[i] ? last -> skip) ; got := got + 1) until got == 6 ; stop }
}

process Collected {
  communication {
    cell[2]   : Cell
    collector : Collector

    for i < 2 { cell[i].number -> collector.number[i] }
    collector.sum -> _
  }

  composition { (par i < 2 : cell[i]) || collector }
}

assert Collected deadlock free
"""


def test_the_run_in_the_order_of_its_times_is_reported() -> None:
    """Each cell writes every two milliseconds, so none can be served three times before the other is."""
    answer = answer_to(TURNS)
    assert (answer.outcome, answer.replayed) == ("refuted", True)
    assert answer.counterexample is not None
    reported = [step for step in answer.counterexample.steps if step.kind == "communication"]
    assert len(reported) == 6
    for earlier, later in ((0, 1), (2, 3), (4, 5)):
        assert reported[earlier].channel != reported[later].channel
    assert all(party.span is not None for step in reported for party in step.parties)


def test_a_replay_reports_the_instants_of_its_steps(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    program, trace = tmp_path / "turns.csp", tmp_path / "trace.json"
    program.write_text(TURNS)
    main(["verify", str(program), "--no-cache", "--quiet", "--trace-out", str(trace)])
    capsys.readouterr()
    assert main(["run", str(program), "--replay", str(trace)]) == 0
    reported = [line.split() for line in capsys.readouterr().err.splitlines() if "number" in line]
    assert [(instant, unit) for _, instant, unit, *_ in reported] == [
        (instant, unit) for instant, unit in (("0", "s"), ("2", "ms"), ("4", "ms")) for _ in range(2)
    ]


NEVER_WAITS = """process Chatters {
  out a, b : bool

  communication { var n : int = 0 }

  composition { mu (a ! true ; (if n == 100 then wait 1 ms else b ! true)) }
}

process Alternates {
  out a, b : bool

  communication { var n : int = 0 }

  composition { mu (a ! true ; (if n == 100 then wait 1 ms else ORDER)) }
}

assert Chatters refines Alternates
"""


def test_a_process_that_never_waits_is_stopped() -> None:
    assert refuted(NEVER_WAITS.replace("ORDER", "(a ! true ; b ! true)"))
    assert answer_to(NEVER_WAITS.replace("ORDER", "b ! true")).outcome == "proved"


AT_ONCE = """process Starts {
  in  go   : bool
  out sent : bool

  communication { var b : bool = false }

  composition { sent ! true ; (go ? b -> sent ! false [] sent ! b -> skip) ; stop }
}

process Ignores {
  in  go   : bool
  out sent : bool

  composition { sent ! true ; sent ! false ; stop }
}

assert Starts refines Ignores
"""


def test_the_environment_may_act_just_before_a_process_checks() -> None:
    """The alternative follows immediately after the first output, and can always take the second one."""
    assert refuted(AT_ONCE)


DRIFTS = """process Feeds {
  out food : int

  composition { mu (food ! 1 ; wait EVERY) }
}

process Eats {
  in food : int

  communication { var v : int = 0  var starved : bool = false }

  composition { wait 1 ms ; mu ((food ? v -> wait 10 ms []> skip -> starved := true)) until starved }
}

process Both {
  communication {
    feeds : Feeds
    eats  : Eats

    feeds.food -> buffer 1 -> eats.food
  }

  composition { feeds || eats }
}

assert Both terminates
"""


def test_a_repeated_cycle_keeps_its_times() -> None:
    """If one loop is a little slower than the other, the two run in step ten times, and then halt."""
    for every, is_forever in (("10 ms", True), ("10100 us", False)):
        answer = answer_to(DRIFTS.replace("EVERY", every))
        assert answer.replayed
        assert answer.counterexample is not None
        assert bool(answer.counterexample.cycle) == is_forever


RAISES = """exception Broken

process Raises {
  out a : bool
  out b : bool

  composition { a ! true ; raise Broken }
}

process Goes {
  out a : bool
  out b : bool

  composition { SPECIFICATION }
}

assert Raises refines Goes
"""


def test_a_program_that_ends_by_an_exception_keeps_its_earlier_effects() -> None:
    assert refuted(RAISES.replace("SPECIFICATION", "b ! true"))
    assert answer_to(RAISES.replace("SPECIFICATION", "a ! true")).outcome == "proved"


def test_a_program_that_ends_offers_nothing_more() -> None:
    text = RAISES.replace("refines Goes", "refines Goes in failures").replace(" ; raise Broken", "")
    assert refuted(text.replace("SPECIFICATION", "a ! true ; b ! true"))
    assert answer_to(text.replace("SPECIFICATION", "a ! true")).outcome == "proved"


NEVER_LATE = """process Follows {
  in  x : double @ 1 ms
  out o : bool

  communication { var now : double = 0 }

  composition { (mu (x ? now ; o ! true ; wait PAUSE)) catch Timeout -> stop }
}

process Tells {
  out o : bool

  composition { mu (o ! true) }
}

assert Follows refines Tells in failures hide x
"""


@pytest.mark.parametrize(("pause", "is_late"), [("0 ms", False), ("2 ms", True)])
def test_a_sample_that_is_taken_was_not_missed(pause: str, is_late: bool) -> None:
    assert refuted(NEVER_LATE.replace("PAUSE", pause)) == is_late


LOGGED = """submodel Law {
  in  e : double
  out u : double

  u = 3 * e
}

process Loop {
  in  e     : double @ 1 ms
  out trace : double

  communication {
    law : Law
    var y : double = 0

    e     -> law.e
    law.u -> y
  }

  composition { mu (law ; trace ! y) }
}

process Logger {
  in trace : double

  communication { var y : double = 0 }

  composition { mu (trace ? y ; wait 20 ms) }
}

process Logged {
  in e : double @ 1 ms

  communication {
    loop   : Loop
    logger : Logger

    e          -> loop.e
    loop.trace -> overwrite 4 -> logger.trace
  }

  composition { loop ||> logger }
}

assert Logged terminates
"""


def test_loops_of_different_rates_continue_forever() -> None:
    """The cycle that is found has one iteration of each; twenty of the first take as long as one of the other."""
    assert refuted(LOGGED)


def test_a_stuck_process_does_not_end() -> None:
    """Without priorities and times the second process may be neglected; a program that halts has not ended either."""
    for delay, comes_too_late in (("wait 5 ms", False), ("wait 15 ms", True)):
        text = RACE.replace("DELAY", delay).replace("assert Both deadlock free", "assert Both terminates")
        assert refuted(text) == comes_too_late


OFFERS = """process Offers {
  out c, o : int
  in d     : int

  communication { var v : int = 0  var late : bool = false }

  composition { OFFERS_ }
}

process Takes {
  in c     : int
  out d, o : int

  communication { var v : int = 0 }

  composition { TAKES_ }
}

process Both {
  out o, p : int

  communication {
    offers : Offers
    takes  : Takes

    offers.c -> takes.c
    takes.d  -> offers.d
    offers.o -> o
    takes.o  -> p
  }

  composition { offers || takes }
}

assert Both terminates
"""


@pytest.mark.parametrize(
    ("offers", "takes", "before", "again"),
    [
        ("mu (c ! 1 -> skip []> after 2 ms -> skip)", "c ? v", ["c"], ["after 2 ms"]),
        ("mu (c ! 1 -> skip []> after 2 ms -> o ! 2)", "c ? v ; o ! 1", ["c", "p"], ["after 2 ms", "o"]),
        (
            "mu ((c ! 1 -> (d ? v -> skip []> after 1 ms -> late := true) []> after 2 ms -> skip) ;"
            " (if late then wait 1 ms)) until v == 2",
            "mu (c ? v ; wait 1 ms ; d ! v + 1)",
            ["c", "after 1 ms", "wait 1 ms"],
            ["wait 1 ms", "after 2 ms"],
        ),
        ("(mu (wait 1 ms)) ; c ! 1", "o ! 1 ; c ? v", ["p"], ["wait 1 ms"]),
        ("mu (c ! 1 ; wait 2 ms)", "mu (c ? v)", [], ["c", "wait 2 ms"]),
    ],
)
def test_steps_required_before_a_round_are_reported(
    offers: str, takes: str, before: list[str], again: list[str]
) -> None:
    """No time passes while a process can continue, so a delay is never the first to happen next to an offer."""
    answer = answer_to(OFFERS.replace("OFFERS_", offers).replace("TAKES_", takes))
    found = answer.counterexample
    assert answer.replayed
    assert found is not None
    assert [_last(step) for step in found.steps if step.shown] == before
    assert [_last(step) for step in found.cycle if step.shown] == again
    assert ("at once" in headline(found)) == (not before)


def _last(step: Step) -> str:
    """A delay, or the name of a channel without those of the processes."""
    return step.channel.rpartition(": ")[2].rpartition(".")[2]


def test_a_process_stuck_after_a_caught_fault_is_where_the_handler_stops() -> None:
    composition = "(mu (wait 1 ms ; n := n - 1 ; beat ! 10 / n)) catch Fault -> stop"
    answer = answer_to(
        f"process Main {{ out beat : int communication {{ var n : int = 3 }} composition {{ {composition} }} }}\n"
        "assert Main terminates\n"
    )
    assert answer.counterexample is not None
    assert [process.words for process in answer.counterexample.waiting] == ["waits forever, at stop"]
