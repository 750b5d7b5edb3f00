"""Entire programs with figures that can be worked out on paper."""

from __future__ import annotations

import pytest

from tests.analyses.timing.programs import MS, US, by_name, law, loops_of, report_of

LOGGED = (
    law("Control", "100 us") + law("Log", "700 us") +
    """
    process Main {
      in  x : double @ 1 ms
      out y : double @ 1 ms
      communication {
        control : Control
        log     : Log
        channel records : double overwrite 1
        var result : double = 0
        var record : double = 0
        x -> control.x
        control.y -> result
        record -> log.x
        log.y -> _
      }
      composition { mu (control ; y ! result ; records ! result) ||> mu (records ? record ; log) }
    }
    """
)  # fmt: skip


def test_a_slow_logger_blocks_for_one_step_and_never_makes_the_loop_wait_for_it() -> None:
    report = report_of(LOGGED)
    (loop,) = report.loops
    assert loop.partners == ()
    assert (loop.work, loop.blocking, loop.response) == (100 * US, 700 * US - 1, 800 * US - 1)
    assert report.utilization == pytest.approx(0.8)
    assert [(chain.reaction, chain.age) for chain in report.chains] == [(2 * MS, 1 * MS)]


def test_a_logger_that_shares_the_level_is_waited_for_as_often_as_it_may_have_been_begun() -> None:
    """The record of the previous sample may still be written when that of this sample is."""
    (loop,) = report_of(LOGGED.replace("||>", "||")).loops
    assert 800 * US <= (loop.response or 0) <= 1500 * US


def test_an_offset_changes_no_bound() -> None:
    """Loops that begin later than others may meet them in any phase."""
    text = loops_of(("a", "1 ms", "100 us"), ("b", "5 ms", "300 us"), order="||>")
    later = text.replace("mu b", "(wait 3 ms ; mu b)")
    assert later != text
    found = {name: (loop.response, loop.blocking) for name, loop in by_name(report_of(text)).items()}
    assert found == {"a": (400 * US - 1, 300 * US - 1), "b": (400 * US, 0)}
    assert {name: (loop.response, loop.blocking) for name, loop in by_name(report_of(later)).items()} == found


EVENT = (
    law("Law", "100 us") + law("Handle", "400 us") +
    """
    process Main {
      in  x : double @ 1 ms
      in  e : double
      out y : double @ 1 ms
      communication {
        law    : Law
        handle : Handle
        var pressed : double = 0
        x -> law.x
        law.y -> y
        pressed -> handle.x
        handle.y -> _
      }
      composition { mu law || mu (e ? pressed ; handle) }
    }
    """
)  # fmt: skip
BENCH = """
    submodel Source { out x, e : double  x = time / 1 s  e = time / 1 s }
    environment Bench for Main step 5 ms { source : Source  source.x -> x  source.e -> e  y -> _ }
    """


def test_events_occur_as_often_as_the_environment_steps() -> None:
    report = report_of(EVENT + BENCH)
    (loop,) = report.loops
    assert loop.response == 500 * US
    assert report.utilization == pytest.approx(0.1 + 0.08)


def test_events_that_nothing_generates_are_not_guessed() -> None:
    (refusal,) = report_of(EVENT).refusals
    assert refusal.reason == "it computes after the event `e`, and how often cannot be seen"
    assert refusal.help.startswith(
        "give the program an environment, whose `step` is the shortest time between two events"
    )


def test_computed_delays_are_not_guessed() -> None:
    text = (
        law("Law", "100 us") +
        """
        process Main {
          out y : double
          communication {
            law : Law
            var pause : time = 1 ms
            var value : double = 0
            value -> law.x
            law.y -> y
          }
          composition { mu (wait pause ; law) }
        }
        """
    )  # fmt: skip
    (refusal,) = report_of(text).refusals
    assert refusal.reason == "it computes after a delay of unknown length, and how often cannot be seen"
    assert refusal.help == "let how long it waits be a constant, longer than zero"


def three_loops(kind: str) -> str:
    laws = law("First", "100 us") + law("Second", "200 us", "p, x") + law("Third", "300 us", "p, x")
    return (
        laws
        + f"""
        process Main {{
          in  a : double @ 2 ms
          in  b : double @ 5 ms
          in  c : double @ 10 ms
          out y : double @ 10 ms
          communication {{
            first  : First
            second : Second
            third  : Third
            channel one : double {kind}
            channel two : double {kind}
            var made  : double = 0
            var more  : double = 0
            var taken : double = 0
            var later : double = 0
            a -> first.x
            first.y -> made
            taken -> second.p
            b -> second.x
            second.y -> more
            later -> third.p
            c -> third.x
            third.y -> y
          }}
          composition {{
            mu (first ; one ! made)
            || mu (one ? taken -> skip [] b -> (second ; two ! more))
            || mu (two ? later -> skip [] c -> third)
          }}
        }}
        """
    )


def test_a_chain_of_three_loops_adds_periods_and_responses() -> None:
    report = report_of(three_loops("overwrite 1"))
    assert {loop.response for loop in report.loops} == {600 * US}
    (chain,) = [chain for chain in report.chains if chain.source == "a"]
    assert chain.loops == ("first", "second", "third")
    # For each of the first two, a period and a response, and the response of the process that takes the value; the
    # output changes a period after the last sample.
    passed = 2 * MS + 2 * 600 * US + 5 * MS + 2 * 600 * US
    assert (chain.reaction, chain.age) == (passed + 20 * MS, passed + 10 * MS)
