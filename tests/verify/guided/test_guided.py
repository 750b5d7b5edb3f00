"""A refutation is a real run of the program: with its priorities, and in exact times."""

from __future__ import annotations

import pytest

from cspdiag.verify.guided import guided
from tests.support.verifying import answer_to, refuted


@pytest.fixture(autouse=True)
def few_actions(monkeypatch: pytest.MonkeyPatch) -> None:
    """Candidates that no run reaches are searched until none is left."""
    monkeypatch.setattr(guided, "MOST_ACTIONS", 10_000)


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
def test_delays_end_on_time(delay: str, comes_too_late: bool) -> None:
    """At one instant the two may happen in either order."""
    assert refuted(RACE.replace("DELAY", delay)) == comes_too_late


def test_the_reason_says_which_delay_is_over_before_which() -> None:
    answer = answer_to(RACE.replace("DELAY", "wait 5 ms"))
    assert "at 5 ms, `waits` continues with `slow.done` before `after 10 ms`, and proofs leave times out" in (
        answer.reason
    )


def test_computations_take_any_time() -> None:
    """The same delay, and a control law before the write."""
    law = "submodel Law {\n  in  x : double\n  out y : double\n\n  y = 2 * x\n}\n\n"
    text = RACE.replace("DELAY", "law ; wait 5 ms")
    text = text.replace(
        "  out done : int\n\n  composition { law",
        "  out done : int\n\n  communication {\n    law : Law\n    var x : double = 1\n    x -> law.x\n    law.y -> "
        "_\n  }\n\n"
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


def test_a_watchdog_that_is_kicked_in_time_does_not_fire() -> None:
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


def test_others_continue_until_a_delay_is_over() -> None:
    """Twenty samples are taken before two processes wait for each other, although the counterexample does not
    say so.
    """
    assert refuted(BESIDE)


MISSES = """process Late {
  in x : double @ 1 ms

  communication { var now : double = 0 }

  composition { (mu (x ? now ; WORK)) catch Timeout -> stop }
}

assert Late deadlock free
"""


@pytest.mark.parametrize(("work", "is_missed"), [("wait 500 us", False), ("wait 2500 us", True), ("skip", False)])
def test_samples_are_missed_by_a_late_process(work: str, is_missed: bool) -> None:
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
def test_the_more_urgent_process_continues_first_alone_or_with_a_buffer(channel: str) -> None:
    """The value is there before the process with the lower priority checks, unless a delay comes before it."""
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


RING = """const size = 20

process Head {
  in  i : int
  out o : int

  communication { var x : int = 0 }

  composition { mu (o ! x ; i ? x) }
}

process Cell {
  in  i : int
  out o : int

  communication { var x : int = 0 }

  composition { mu (i ? x ; o ! x) }
}

process Whole {
  communication {
    head       : Head
    cell[size] : Cell

    head.o -> cell[0].i

    for i < size - 1 { cell[i].o -> cell[i + 1].i }

    cell[size - 1].o -> head.i
  }

  composition { head || (par i < size : cell[i]) }
}

assert Whole livelock free
"""


def test_a_round_with_more_steps_than_runs_may_have_otherwise_is_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(guided, "MOST_ACTIONS", 40)
    monkeypatch.setattr(guided, "AT_LEAST", 10)
    assert refuted(RING)
