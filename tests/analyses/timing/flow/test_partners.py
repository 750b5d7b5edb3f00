"""Loops that wait for partners: what belongs to a sample, what is passed on, and what has no bound."""

from __future__ import annotations

import pytest

import cspdiag
from cspdiag.analyses.timing.report.timing import timing_report
from tests.analyses.timing.programs import MS, US, by_name, law, report_of
from tests.models.programs import MODELS
from tests.support.verifying import answers_to

CASCADE = {"Cascade.inner.law": 20 * US, "Cascade.outer.law": 30 * US}


def test_the_outer_loop_of_the_cascade_waits_for_the_inner_one_no_longer_than_it_works() -> None:
    report = timing_report(cspdiag.load(MODELS / "cascade" / "cascade.csp").network, CASCADE)
    loops = by_name(report)
    assert report.is_schedulable is True
    assert loops["outer.law"].partners == ("inner",)
    assert loops["outer.law"].response == 50 * US
    assert loops["inner.law"].partners == ()
    assert loops["inner.law"].response == 50 * US - 1
    assert loops["inner.law"].blocking == 30 * US - 1


def test_chains_lead_through_both_loops_of_the_cascade() -> None:
    report = timing_report(cspdiag.load(MODELS / "cascade" / "cascade.csp").network, CASCADE)
    found = {(chain.source, chain.sink): chain for chain in report.chains}
    assert set(found) == {("reference", "voltage"), ("speed", "voltage"), ("current", "voltage")}
    direct = found["current", "voltage"]
    assert (direct.reaction, direct.age) == (200 * US, 100 * US)
    through = found["speed", "voltage"]
    assert through.loops == ("outer.law", "inner.law")
    assert through.age == 1 * MS + 50 * US + 100 * US
    assert through.reaction == through.age + 100 * US


PIPELINE = (
    law("Sense", "100 us") + law("Compute", "200 us") + law("Log", "50 us") +
    """
    process Computing {
      in  input : double
      out output : double
      communication {
        compute : Compute
        input -> compute.x
        compute.y -> output
      }
      composition { mu compute }
    }
    process Main {
      in  x, z : double @ 1 ms
      out w    : double @ 1 ms
      communication {
        sense     : Sense
        computing : Computing
        log       : Log
        x -> sense.x
        sense.y -> passed : double -> computing.input
        computing.output -> _
        z -> log.x
        log.y -> w
      }
      composition { <order> }
    }
    """
)  # fmt: skip


def pipeline(order: str) -> str:
    return PIPELINE.replace("<order>", order)


def test_the_work_of_an_unsampled_partner_is_part_of_the_sample_that_wakes_it() -> None:
    loops = by_name(report_of(pipeline("mu sense || computing || mu log")))
    assert loops["sense"].partners == ("computing",)
    assert loops["sense"].work == 300 * US
    assert loops["sense"].response == 350 * US
    # The log may meet the computation of this sample and, late, that of the previous one.
    assert 350 * US <= (loops["log"].response or 0) <= 550 * US


def test_what_an_unsampled_partner_writes_belongs_to_the_loop() -> None:
    text = pipeline("mu sense || computing || mu log").replace("computing.output -> _", "computing.output -> v")
    report = report_of(text.replace("out w    : double @ 1 ms", "out w, v : double @ 1 ms"))
    loop = by_name(report)["sense"]
    assert loop.outputs == ("v",)
    assert loop.latency == (1 * MS, 1 * MS)
    assert {(chain.source, chain.sink, chain.age) for chain in report.chains} == {
        ("x", "v", 1 * MS),
        ("z", "w", 1 * MS),
    }


def test_a_less_urgent_partner_makes_the_loop_as_urgent_as_itself() -> None:
    loops = by_name(report_of(pipeline("mu sense ||> mu log ||> computing")))
    assert loops["sense"].priority == 2
    assert loops["sense"].response == 350 * US
    assert loops["log"].priority == 1


def waiting(body: str, port: str = "") -> str:
    text = WAITING.replace("<body>", body).replace("<port>", port).replace("<outer>", port)
    return text.replace("<wired>", "go -> other.go" if port else "")


def refused(text: str) -> str:
    report = report_of(text)
    assert report.is_schedulable is None
    assert report.missing == ()
    refusal = report.refusals[0]
    assert refusal.span.line > 1
    assert refusal.help
    return f"{refusal.subject}: {refusal.reason}"


WAITING = (
    law("Law", "100 us") +
    """
    process Other {
      in  value : double
      <port>
      communication {
        var got : double = 0
        var seen : double = 0
      }
      composition { mu (<body>) }
    }
    process Main {
      in  x : double @ 1 ms
      <outer>
      communication {
        law   : Law
        other : Other
        x     -> law.x
        law.y -> passed : double -> other.value
        <wired>
      }
      composition { mu law || other }
    }
    """
)  # fmt: skip


@pytest.mark.parametrize(
    ("port", "body", "reason"),
    [
        ("in go : double", "value ? got ; go ? seen", "may wait for the event `go` meanwhile"),
        ("in go : double @ 7 ms", "value ? got ; go ? seen", "may wait for a sample of 7 ms meanwhile"),
        ("", "value ? got ; wait 3 ms", "may wait for time to pass meanwhile"),
    ],
)
def test_a_partner_that_may_wait_for_something_else_has_no_bound(port: str, body: str, reason: str) -> None:
    reason_given = refused(waiting(body, port))
    assert reason_given.startswith("Main.law: it waits at `passed` without bound")
    assert reason_given.endswith(reason)


def test_a_partner_that_offers_the_channel_wherever_it_waits_has_one() -> None:
    text = waiting("value ? got -> skip [] go ? seen -> skip", "in go : double")
    assert report_of(text).is_schedulable is True


def test_an_overwriting_channel_needs_no_partner() -> None:
    text = waiting("value ? got ; wait 3 ms").replace("passed : double ->", "passed : double overwrite 1 ->")
    assert report_of(text).is_schedulable is True


def test_an_event_between_samples_has_no_bound() -> None:
    text = """
        process Main {
          in  x  : double @ 1 ms
          in  go : int
          out y  : double @ 1 ms
          communication {
            var value   : double = 0
            var pressed : int    = 0
          }
          composition { mu (x ? value ; go ? pressed ; y ! value) }
        }
        """
    assert refused(text) == "Main: between its samples it waits for the event `go`, without bound"


def test_two_periods_in_one_loop_have_no_bound() -> None:
    text = """
        process Main {
          in  x : double @ 1 ms
          in  z : double @ 5 ms
          out y : double @ 1 ms
          communication {
            var one   : double = 0
            var other : double = 0
          }
          composition { mu (x ? one ; z ? other ; y ! one) }
        }
        """
    assert refused(text).startswith("Main: one loop waits for samples of 1 ms and of 5 ms")


def test_two_periods_in_one_alternative_are_two_loops() -> None:
    text = (
        law("Fast", "100 us") + law("Slow", "200 us") +
        """
        process Main {
          in  x : double @ 1 ms
          in  z : double @ 5 ms
          out y : double @ 1 ms
          out w : double @ 5 ms
          communication {
            fast : Fast
            slow : Slow
            x -> fast.x
            z -> slow.x
            fast.y -> y
            slow.y -> w
          }
          composition { mu (x -> fast [] z -> slow) }
        }
        """
    )  # fmt: skip
    loops = by_name(report_of(text))
    assert {name: (loop.period, loop.response) for name, loop in loops.items()} == {
        "fast": (1 * MS, 300 * US),
        "slow": (5 * MS, 300 * US),
    }


def test_work_after_events_needs_an_environment_that_says_how_often_they_come() -> None:
    text = (
        law("Law", "100 us") + law("Answer", "200 us") +
        """
        process Main {
          in  x  : double @ 1 ms
          in  go : double
          out y  : double @ 1 ms
          out z  : double
          communication {
            law    : Law
            answer : Answer
            x  -> law.x
            go -> answer.x
            law.y    -> y
            answer.y -> z
          }
          composition { mu law || mu answer }
        }
        """
    )  # fmt: skip
    assert refused(text) == "Main.answer: it computes after the event `go`, and how often cannot be seen"
    bench = """
        environment Bench for Main step 1 ms { s : Source  s.x -> x  s.go -> go  y -> _  z -> _ }
        submodel Source { out x, go : double x = 1 go = time / 1 s }
        """
    (loop,) = report_of(text + bench).loops
    assert loop.response == 300 * US
    report = report_of(text + bench.replace("step 1 ms", "step 250 us"))
    (loop,) = report.loops
    assert loop.response == 300 * US
    assert report.utilization == pytest.approx(0.9)


def test_an_input_that_another_branch_of_the_same_process_reads_begins_no_chain() -> None:
    text = (
        law("Outer", "200 us") + law("Inner", "100 us", inputs="x, wish") +
        """
        process Main {
          in  angle : double @ 10 ms
          in  speed : double @ 1 ms
          in  stop  : bool
          out voltage : double @ 1 ms
          communication {
            outer : Outer
            inner : Inner
            var pressed : bool = false
            var target  : double = 0
            channel wish : double overwrite 1
            angle   -> outer.x
            outer.y -> wish
            speed   -> inner.x
            target  -> inner.wish
            inner.y -> voltage
          }
          composition {
            mu outer || mu (stop ? pressed -> skip [] wish ? target -> skip [] speed -> inner)
          }
        }
        """
    )  # fmt: skip
    found = {(chain.source, chain.loops) for chain in report_of(text).chains}
    assert found == {("angle", ("outer", "inner")), ("speed", ("inner",))}


ON_ARRIVAL = (
    law("Sense", "100 us") + law("Compute", "300 us") + law("Control", "50 us") + law("Log", "10 us") +
    """
    process Main {
      in  x, s, z : double @ 1 ms
      out w, v    : double @ 1 ms
      communication {
        sense   : Sense
        compute : Compute
        control : Control
        log     : Log
        channel passed : double <kind>
        var sensed : double = 0
        var taken  : double = 0
        x -> sense.x
        sense.y -> sensed
        taken -> compute.x
        compute.y -> _
        s -> control.x
        control.y -> v
        z -> log.x
        log.y -> w
      }
      composition { mu (sense ; passed ! sensed) || mu (passed ? taken -> compute [] s -> control) || mu log }
    }
    """
)  # fmt: skip


@pytest.mark.parametrize("kind", ["", "overwrite 1", "overwrite 2", "buffer 1"])
def test_work_that_an_arrival_begins_adds_to_that_of_the_samples(kind: str) -> None:
    report = report_of(ON_ARRIVAL.replace("<kind>", kind))
    assert report.utilization == pytest.approx(0.46)
    assert by_name(report)["log"].response >= 460 * US  # type: ignore[operator]


def test_work_passed_on_twice_counts_for_parallel_processes() -> None:
    """The second loop takes what the first writes between its own samples, and makes a third thread compute."""
    text = ON_ARRIVAL.replace("<kind>", "").replace(
        "mu (passed ? taken -> compute [] s -> control)",
        "mu (passed ? taken -> further ! taken [] s -> control) || mu (further ? more -> compute)",
    )
    text = text.replace("taken -> compute.x", "var more : double = 0  channel further : double  more -> compute.x")
    report = report_of(text)
    assert report.utilization == pytest.approx(0.46)
    assert by_name(report)["log"].response >= 460 * US  # type: ignore[operator]


FOLLOWERS = """process Leader {
  in  target   : double
  out setpoint : double

  communication { var wanted : double = 0 }

  composition { mu (target ? wanted ; setpoint ! wanted) }
}

process Follower {
  in  setpoint : double
  in  angle    : double @ 1 ms
  out drive    : double @ 1 ms

  communication {
    var wanted : double = 0
    var now    : double = 0
  }

  composition { mu (setpoint ? wanted ; angle ? now ; drive ! wanted - now) }
}

process Convoy {
  in  target   : double
  in  angle[2] : double @ 1 ms
  out drive[2] : double @ 1 ms

  communication {
    leader      : Leader
    follower[2] : Follower

    target          -> leader.target
    leader.setpoint -> broadcast -> follower[0].setpoint, follower[1].setpoint
    for i < 2 {
      angle[i]          -> follower[i].angle
      follower[i].drive -> drive[i]
    }
  }

  composition { leader || (par i < 2 : follower[i]) }
}

assert Convoy schedulable
"""


def test_a_label_of_several_instances_is_shown_once() -> None:
    (answer,) = answers_to({"case.csp": FOLLOWERS})
    assert answer.found is not None
    reported = [(label.message, label.span) for label in answer.found.labels]
    assert any("without bound" in text for text, _ in reported)
    assert len(set(reported)) == len(reported)
