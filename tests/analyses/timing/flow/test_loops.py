"""From programs to response times: what counts as a loop, what delays it, and what has no bound."""

from __future__ import annotations

import pytest

import cspdiag
from cspdiag.analyses.timing.report.timing import timing_report
from tests.analyses.timing.programs import MS, US, by_name, law, loops_of, report_of
from tests.models.programs import MODELS


def test_equal_priorities_wait_for_each_other_once() -> None:
    loops = by_name(report_of(loops_of(("a", "10 ms", "300 us"), ("b", "1 ms", "200 us"))))
    assert (loops["a"].response, loops["b"].response) == (500 * US, 500 * US)
    assert (loops["a"].blocking, loops["b"].blocking) == (0, 0)
    assert loops["b"].slack == 500 * US
    assert loops["b"].utilization == 0.2


def test_a_more_urgent_loop_waits_for_the_step_that_runs() -> None:
    loops = by_name(report_of(loops_of(("a", "1 ms", "200 us"), ("b", "10 ms", "300 us"), order="||>")))
    assert loops["a"].blocking == 300 * US - 1
    assert loops["a"].response == 500 * US - 1
    assert loops["b"].response == 500 * US
    assert loops["a"].priority < loops["b"].priority


def test_what_is_less_urgent_is_overtaken_until_it_starts() -> None:
    loops = by_name(report_of(loops_of(("a", "1 ms", "600 us"), ("b", "10 ms", "900 us"), order="||>")))
    # 600 us of a, again at 1 ms; what starts after 1.6 ms does not have to wait for any more of it before 2 ms.
    assert loops["b"].start == 600 * US
    assert loops["a"].response == 1500 * US - 1
    assert not loops["a"].is_met
    assert loops["b"].is_met


def test_overload_is_refuted_without_a_bound() -> None:
    report = report_of(loops_of(("a", "1 ms", "600 us"), ("b", "1 ms", "500 us")))
    assert report.is_schedulable is False
    assert {loop.response for loop in report.loops} == {None}
    assert report.utilization == pytest.approx(1.1)
    assert report.is_edf_feasible is False


def test_another_order_of_priorities_is_advised() -> None:
    report = report_of(
        loops_of(("slow", "10 ms", "700 us"), ("fast", "1 ms", "200 us"), ("mid", "4 ms", "600 us"), order="||>")
    )
    assert report.is_schedulable is None
    assert report.advice == ("fast", "mid", "slow")
    better = report_of(
        loops_of(("fast", "1 ms", "200 us"), ("mid", "4 ms", "600 us"), ("slow", "10 ms", "700 us"), order="||>")
    )
    assert better.is_schedulable is True
    assert better.advice is None


def test_modes_in_sequence_exclude_each_other() -> None:
    text = (
        law("First", "100 us") + law("Second", "400 us") + law("Beside", "50 us") +
        """
        process Main {
          in  x, z : double @ 1 ms
          in  go   : int
          out y, w : double @ 1 ms
          communication {
            first  : First
            second : Second
            beside : Beside
            var pressed : int = 0
            x -> first.x, second.x
            z -> beside.x
            first.y, second.y -> y
            beside.y -> w
          }
          composition { ((mu first) interrupt go ? pressed -> skip ; mu second) || mu beside }
        }
        environment Bench for Main {
          plant : Plant
          plant.x -> x
          plant.z -> z
          plant.go -> go
          y -> _
          w -> _
        }
        submodel Plant { out x, z : double  out go : int  x = 1  z = 1  go = if time < 1 s then 0 else 1 }
        """
    )  # fmt: skip
    loops = by_name(report_of(text))
    assert (loops["first"].response, loops["second"].response) == (150 * US, 450 * US)
    assert loops["beside"].response == 450 * US
    assert report_of(text).utilization == pytest.approx(0.45)


def test_laws_in_sequence_on_one_sample_add_up_in_one_step() -> None:
    text = (
        law("Filter", "100 us") + law("Control", "200 us") +
        """
        process Main {
          in  x : double @ 1 ms
          out y : double @ 1 ms
          communication {
            filter  : Filter
            control : Control
            x -> filter.x
            filter.y -> control.x
            control.y -> y
          }
          composition { mu (filter ; control) }
        }
        """
    )  # fmt: skip
    report = report_of(text)
    (loop,) = report.loops
    assert (loop.work, loop.step, loop.response) == (300 * US, 300 * US, 300 * US)
    assert loop.outputs == ("y",)
    (chain,) = report.chains
    assert (chain.source, chain.sink, chain.reaction, chain.age) == ("x", "y", 2 * MS, 1 * MS)


def test_of_two_sides_the_longer_counts() -> None:
    text = (
        law("Short", "100 us") + law("Long", "300 us") +
        """
        process Main {
          in  x : double @ 1 ms
          out y : double @ 1 ms
          communication {
            short : Short
            long  : Long
            var value : double = 0
            value -> short.x, long.x
            short.y, long.y -> y
          }
          composition { mu (x ? value ; if value > 0 then short else long) }
        }
        """
    )  # fmt: skip
    (loop,) = report_of(text).loops
    assert loop.work == 300 * US


def test_parallel_laws_within_a_loop_add_up_but_are_separate_steps() -> None:
    text = (
        law("Left", "100 us") + law("Right", "300 us") +
        """
        process Main {
          in  x, z : double @ 1 ms
          out y, w : double @ 1 ms
          communication {
            left  : Left
            right : Right
            x -> left.x
            z -> right.x
            left.y  -> y
            right.y -> w
          }
          composition { mu (left || right) }
        }
        """
    )  # fmt: skip
    (loop,) = report_of(text).loops
    assert (loop.work, loop.step) == (400 * US, 300 * US)


def test_a_delay_within_a_loop_is_part_of_it() -> None:
    text = """
        process Main {
          in  x : double @ 10 ms
          out y : double @ 10 ms
          communication { var value : double = 0 }
          composition { mu (x ? value ; wait 2 ms ; y ! value) }
        }
        """
    (loop,) = report_of(text).loops
    assert (loop.work, loop.step, loop.response) == (0, 0, 2 * MS)


def test_latched_outputs_have_no_jitter_and_immediate_ones_do() -> None:
    latched = by_name(report_of(loops_of(("a", "1 ms", "200 us"), ("b", "1 ms", "300 us"))))["a"]
    assert latched.latency == (MS, MS)
    assert latched.jitter == 0
    immediate = by_name(report_of(loops_of(("a", "1 ms", "200 us"), ("b", "1 ms", "300 us"), latch="immediate")))["a"]
    assert immediate.latency == (0, 500 * US)
    assert immediate.jitter == 500 * US


def test_a_late_output_comes_a_period_later() -> None:
    loops = by_name(report_of(loops_of(("a", "1 ms", "600 us"), ("b", "10 ms", "900 us"), order="||>")))
    assert loops["a"].latency == (MS, 2 * MS)


def test_times_stated_by_a_process_replace_those_of_its_laws() -> None:
    text = loops_of(("a", "1 ms", None)).replace("process Main {", "process Main wcet 70 us {")
    (loop,) = report_of(text).loops
    assert (loop.work, loop.step) == (70 * US, 70 * US)


def test_handwritten_processes_state_their_time_themselves() -> None:
    text = """
        process Law wcet 80 us python "law.py:Law" {
          in  x : double
          out y : double
        }
        process Main {
          in  x : double @ 1 ms
          out y : double @ 1 ms
          communication {
            law : Law
            x     -> law.x
            law.y -> y
          }
          composition { law }
        }
        """
    (loop,) = report_of(text).loops
    assert (loop.name, loop.work, loop.response) == ("law", 80 * US, 80 * US)
    missing = report_of(text.replace("wcet 80 us ", "")).missing
    assert [(part.leaf, part.kind) for part in missing] == [("Main.law", "process")]


def test_laws_without_times_are_all_named() -> None:
    report = report_of(loops_of(("a", "1 ms", None), ("b", "1 ms", "100 us"), ("c", "2 ms", None)))
    assert report.is_schedulable is None
    assert [part.leaf for part in report.missing] == ["Main.a", "Main.c"]
    assert [part.span.line for part in report.missing] == [1, 11]
    assert report.loops == ()


def test_measured_times_replace_stated_ones() -> None:
    report = report_of(loops_of(("a", "1 ms", None), ("b", "1 ms", "900 us")), {"Main.a": 100 * US, "Main.b": 50 * US})
    assert report.is_schedulable is True
    assert {loop.work for loop in report.loops} == {100 * US, 50 * US}
    assert report.measured == ("Main.a", "Main.b")


def test_jiwy_is_schedulable() -> None:
    report = timing_report(cspdiag.load(MODELS / "jiwy" / "jiwy.csp").network)
    assert report.is_schedulable is True
    assert len(report.loops) == 8
    assert report.hyperperiod == 2 * MS
    assert report.utilization == pytest.approx(0.09)
    assert all(loop.jitter == 0 for loop in report.loops)
