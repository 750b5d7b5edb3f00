"""A refutation is a run that the program has: with its priorities, and in exact times."""

from __future__ import annotations

import pytest

from cspdiag.analyses.verification.answer import Answer
from tests.verifying import answers_to


def answer_to(text: str) -> Answer:
    (answer,) = answers_to({"case.csp": text})
    return answer


def refuted(text: str) -> bool:
    """Whether the program was stepped through a counterexample; otherwise the answer says why not."""
    answer = answer_to(text)
    assert (answer.outcome, answer.replayed) in {("refuted", True), ("unknown", False)}
    return answer.replayed


RACE = """process Slow {
  out done : int

  composition { DELAY ; done ! 1 }
}

process Waits {
  in done : int

  communication { var value : int }

  composition { done ? value -> skip [] after 10 ms -> stop }
}

process Both {
  communication {
    slow  : Slow
    waits : Waits

    slow.done -> waits.done
  }

  composition { slow || waits }
}

assert Both deadlock free
"""


@pytest.mark.parametrize(
    ("delay", "comes_too_late"),
    [
        ("wait 5 ms", False),
        ("wait 15 ms", True),
        ("wait 10 ms", True),
        ("wait 4 ms ; wait 5 ms", False),
        ("wait 4 ms ; wait 7 ms", True),
        ("(wait 4 ms || wait 9 ms)", False),
        ("(wait 4 ms || wait 11 ms)", True),
    ],
)
def test_delays_end_when_they_say(delay: str, comes_too_late: bool) -> None:
    """At one instant the two may come in either order."""
    assert refuted(RACE.replace("DELAY", delay)) == comes_too_late


def test_the_reason_says_which_delay_is_over_before_which() -> None:
    answer = answer_to(RACE.replace("DELAY", "wait 5 ms"))
    assert "at 5 ms, `Both.waits` goes on with `Both.slow.done` before `after 10 ms`, and proofs leave times out" in (
        answer.reason
    )


def test_computations_take_any_time() -> None:
    """The same delay, and a control law before it writes."""
    law = "submodel Law {\n  in  x : double\n  out y : double\n\n  y = 2 * x\n}\n\n"
    text = RACE.replace("DELAY", "law ; wait 5 ms")
    text = text.replace(
        "  out done : int\n\n  composition { law",
        "  out done : int\n\n  communication {\n    law : Law\n    var x : double = 1\n    x -> law.x\n    law.y -> _\n  }\n\n"
        "  composition { law",
    )
    assert refuted(law + text)


WATCHDOG = """process Feeds {
  out food : int

  composition { mu (wait 9 ms ; food ! 1) }
}

process Watchdog {
  in  food  : int
  out alarm : bool

  communication { var value : int = 0  var hungry : bool = false }

  composition { mu ((food ? value -> skip [] after PATIENCE -> hungry := true)) until hungry ; stop }
}

process Guarded {
  out alarm : bool

  communication {
    feeds    : Feeds
    watchdog : Watchdog

    feeds.food     -> watchdog.food
    watchdog.alarm -> alarm
  }

  composition { feeds || watchdog }
}

assert Guarded deadlock free
"""


def test_a_watchdog_that_is_fed_in_time_does_not_bark() -> None:
    assert not refuted(WATCHDOG.replace("PATIENCE", "10 ms"))
    assert refuted(WATCHDOG.replace("PATIENCE", "8 ms"))


RATES = """process Fast {
  in  level : double @ 1 ms
  out ready  : bool

  communication { var x : double = 0  var n : int = 0 }

  composition { mu (level ? x ; n := n + 1) until n == 3 ; ready ! true }
}

process Slow {
  in level : double @ 5 ms
  in ready  : bool

  communication { var x : double = 0  var r : bool = false }

  composition { ORDER }
}

process Loops {
  in fast : double @ 1 ms
  in slow : double @ 5 ms

  communication {
    a : Fast
    b : Slow

    fast    -> a.level
    slow    -> b.level
    a.ready -> b.ready
  }

  composition { a || b }
}

assert Loops deadlock free
"""


def test_samples_come_at_the_ticks_of_their_periods() -> None:
    """The third sample of the fast loop comes before the first of the slow one."""
    assert not refuted(RATES.replace("ORDER", "level ? x -> stop [] ready ? r -> level ? x"))
    assert refuted(RATES.replace("ORDER", "level ? x -> stop [] ready ? r -> stop"))


BESIDE = """process Samples {
  in x : double @ 1 ms

  communication { var now : double = 0 }

  composition { mu (x ? now) }
}

process Left {
  in  b : int
  out a : int

  communication { var v : int }

  composition { wait 20 ms ; a ! 1 ; b ? v }
}

process Right {
  in  a : int
  out b : int

  communication { var v : int }

  composition { b ! 1 ; a ? v }
}

process All {
  in x : double @ 1 ms

  communication {
    samples : Samples
    left    : Left
    right   : Right

    x       -> samples.x
    left.a  -> right.a
    right.b -> left.b
  }

  composition { samples || left || right }
}

assert All deadlock free
"""


def test_others_go_on_until_a_delay_is_over() -> None:
    """Twenty samples are taken before two processes wait for each other, although the counterexample does not say so."""
    assert refuted(BESIDE)


MISSES = """process Late {
  in x : double @ 1 ms

  communication { var now : double = 0 }

  composition { (mu (x ? now ; WORK)) catch Timeout -> stop }
}

assert Late deadlock free
"""


@pytest.mark.parametrize(("work", "is_missed"), [("wait 500 us", False), ("wait 2500 us", True), ("skip", False)])
def test_samples_are_missed_by_who_comes_too_late(work: str, is_missed: bool) -> None:
    assert refuted(MISSES.replace("WORK", work)) == is_missed


def test_samples_are_missed_while_something_computes() -> None:
    law = "submodel Law {\n  in  x : double\n  out y : double\n\n  y = 2 * x\n}\n\n"
    text = MISSES.replace("WORK", "law").replace(
        "var now : double = 0", "law : Law\n    now -> law.x\n    law.y -> _\n    var now : double = 0"
    )
    assert refuted(law + text)


URGENT = """process Produces {
  out item : int

  composition { BODY }
}

process Idles {
  in item : int

  communication { var v : int }

  composition { item ? v -> skip []> skip -> stop }
}

process Both {
  communication {
    produces : Produces
    idles    : Idles

    produces.item -> CHANNEL idles.item
  }

  composition { produces ||> idles }
}

assert Both deadlock free
"""


@pytest.mark.parametrize("channel", ["", "buffer 2 ->", "overwrite 1 ->"])
def test_who_is_more_urgent_gets_on_first_alone_or_with_a_buffer(channel: str) -> None:
    """The value is there before the less urgent process looks, unless a delay comes before it."""
    text = URGENT.replace("CHANNEL", channel)
    assert not refuted(text.replace("BODY", "item ! 1"))
    assert refuted(text.replace("BODY", "wait 1 ms ; item ! 1"))
    assert refuted(text.replace("BODY", "item ! 1").replace("||>", "||"))


RATE_MONOTONIC = """process Loop(T: time, takes: time) {
  in  x     : double @ T
  out alarm : bool

  communication { var now : double = 0 }

  composition { (mu (x ? now ; wait takes)) catch Timeout -> alarm ! true }
}

process Controller {
  in  fast       : double @ 1 ms
  in  slow       : double @ 5 ms
  out fast_alarm : bool
  out slow_alarm : bool

  communication {
    first  : Loop(T = 1 ms, takes = FIRST)
    second : Loop(T = 5 ms, takes = SECOND)

    fast         -> first.x
    slow         -> second.x
    first.alarm  -> fast_alarm
    second.alarm -> slow_alarm
  }

  composition { first ||> second }
}

process Quiet {
  out fast_alarm : bool
  out slow_alarm : bool

  composition { stop }
}

assert Controller refines Quiet hide fast, slow
"""


@pytest.mark.parametrize(("fast", "slow", "misses"), [("900 us", "4 ms", False), ("1100 us", "4 ms", True)])
def test_loops_that_are_ready_before_their_next_samples_miss_none(fast: str, slow: str, misses: bool) -> None:
    assert refuted(RATE_MONOTONIC.replace("FIRST", fast).replace("SECOND", slow)) == misses


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


def test_what_a_process_refuses_is_seen_before_it_goes_on() -> None:
    """After the first press the specification wants another one; the lamp is lit at once."""
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


def test_where_times_want_another_order_that_run_is_told() -> None:
    """Each cell writes every two milliseconds, so that none can be served three times before the other is."""
    answer = answer_to(TURNS)
    assert (answer.outcome, answer.replayed) == ("refuted", True)
    assert answer.counterexample is not None
    told = [step for step in answer.counterexample.steps if step.kind == "communication"]
    assert len(told) == 6
    for earlier, later in ((0, 1), (2, 3), (4, 5)):
        assert told[earlier].channel != told[later].channel
    assert all(party.span is not None for step in told for party in step.parties)


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


def test_a_process_that_never_waits_is_broken_off() -> None:
    assert refuted(NEVER_WAITS.replace("ORDER", "(a ! true ; b ! true)"))
    assert answer_to(NEVER_WAITS.replace("ORDER", "b ! true")).outcome == "proved"


AT_ONCE = """process Starts {
  in  go   : bool
  out told : bool

  communication { var b : bool = false }

  composition { told ! true ; (go ? b -> told ! false [] told ! b -> skip) ; stop }
}

process Ignores {
  in  go   : bool
  out told : bool

  composition { told ! true ; told ! false ; stop }
}

assert Starts refines Ignores
"""


def test_the_environment_may_act_just_before_a_process_looks() -> None:
    """The alternative comes at once after the first output, and can always take the second one."""
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


def test_what_goes_on_for_ever_does_so_in_its_times() -> None:
    """Where one loop is a little slower than the other, the two go round in step ten times, and then come to a halt."""
    for every, is_for_ever in (("10 ms", True), ("10100 us", False)):
        answer = answer_to(DRIFTS.replace("EVERY", every))
        assert answer.replayed
        assert answer.counterexample is not None
        assert bool(answer.counterexample.cycle) == is_for_ever


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


def test_a_program_that_ends_by_an_exception_has_done_what_it_did_before() -> None:
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
def test_a_sample_that_is_taken_is_none_that_was_missed(pause: str, is_late: bool) -> None:
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


def test_loops_of_different_rates_go_on_for_ever() -> None:
    """The cycle that is found has one round of each; twenty of the first take as long as one of the other."""
    assert refuted(LOGGED)


def test_who_is_stuck_does_not_end() -> None:
    """Without priorities and times the second process may be left alone; a program that comes to a halt has not ended either."""
    for delay, comes_too_late in (("wait 5 ms", False), ("wait 15 ms", True)):
        text = RACE.replace("DELAY", delay).replace("assert Both deadlock free", "assert Both terminates")
        assert refuted(text) == comes_too_late
