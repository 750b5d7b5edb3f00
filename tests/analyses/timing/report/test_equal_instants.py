"""What happens at the instant of a tick happens after the tick: a value written then is output a period later, and work
that ends then does not end before the next sample.
"""

from __future__ import annotations

import random
from collections import Counter
from fractions import Fraction

import pytest

from cspdiag import pipeline
from cspdiag.analyses.timing.report.diagnostics import diagnostic_of
from cspdiag.analyses.timing.report.timing import timing_report
from cspdiag.network.ir.network import Network
from cspdiag.simulate.run.execute import simulate
from tests.analyses.timing.processor import Processor, on_processor, read, run, wcets, with_bench
from tests.analyses.timing.programs import MS, US, by_name, law, loops_of, report_of
from tests.analyses.timing.seen import Seen, seen_in
from tests.support.thorough import usual_or_thorough


def program(loop: str, output: str, steps: str) -> str:
    """A loop without laws, with these periods."""
    return f"""
        process Main {{
          in  x : double @ {loop}
          out y : double @ {output}
          communication {{ var v : double = 0  var w : double = 0 }}
          composition {{ mu ({steps}) }}
        }}
        """


def simulated(text: str) -> Seen:
    """What is observed in a run in which only delays take time."""
    network = with_bench(text, ["x"], ["y"], "500 us")
    return seen_in(simulate(network, pipeline.generate(network, read), until=200 * MS), "Main.y")


@pytest.mark.parametrize(
    ("loop", "output", "steps", "latency", "reaction"),
    [
        # The sample of 36 ms is written at 36 ms and output at 40 ms, when that of 40 ms is not written yet.
        ("4 ms", "5 ms", "x ? v ; y ! v", (1, 4), 9),
        ("2 ms", "3 ms", "x ? v ; y ! v", (1, 2), 5),
        ("3 ms", "2 ms", "x ? v ; y ! v", (1, 2), 5),
        ("5 ms", "5 ms", "x ? v ; y ! v", (5, 5), 10),
        ("6 ms", "4 ms", "x ? v ; wait 2 ms ; y ! v", (2, 6), 12),
        # What is written at the tick of 5.5 ms waits for that of 10.5 ms; a nanosecond earlier it would not.
        ("5 ms", "5 ms offset 500 us", "x ? v ; wait 500 us ; y ! v", (".5", "5.5"), "10.5"),
        ("5 ms", "5 ms offset 500 us", "x ? v ; wait 499999 ns ; y ! v", (".5", ".5"), "5.5"),
        ("5 ms", "5 ms offset 500 us", "x ? v ; y ! v", (".5", ".5"), "5.5"),
        ("4 ms", "2 ms offset 1 ms", "x ? v ; wait 3 ms ; y ! v", (1, 5), 9),
        ("2 ms", "4 ms offset 1 ms", "x ? v ; wait 1 ms ; y ! v", (1, 3), 7),
    ],
)
def test_a_value_written_at_a_tick_is_handed_over_at_the_next(
    loop: str, output: str, steps: str, latency: tuple[str, str], reaction: str
) -> None:
    """The largest age and reaction of a run are the bounds; no output is younger than the shortest latency."""
    text = program(loop, output, steps)
    report = report_of(text)
    (row,) = report.loops
    (chain,) = report.chains
    shortest, longest = (int(Fraction(bound) * MS) for bound in latency)
    assert row.latency == (shortest, longest)
    assert (chain.age, chain.reaction) == (longest, Fraction(reaction) * MS)
    seen = simulated(text)
    assert (seen.age, seen.reaction) == (chain.age, chain.reaction)
    assert seen.youngest >= shortest


@pytest.mark.parametrize(
    ("steps", "age"),
    [
        ("mu (x ? w ; x ? v ; y ! v)", 2),
        ("mu (x ? v ; if v < 0.053 then y ! v else skip)", 8),
        ("(mu (x ? v ; y ! v) until v > 0.053) ; mu (x ? v)", 6),
        ("(mu (x ? v ; w := 1.0 / (v - 0.053) ; y ! v)) catch Fault -> (mu (x ? v))", 8),
        ("(mu (x ? v ; y ! v)) interrupt after 53500 us -> (mu (x ? v))", 7),
    ],
)
def test_what_is_not_written_in_each_sample_may_be_as_old_as_the_period_of_its_output(steps: str, age: int) -> None:
    """At 60 ms the last value that was written is output; if it were written in each sample, it would be that
    of 59 ms.
    """
    text = program("1 ms", "10 ms", "x ? v ; y ! v").replace("mu (x ? v ; y ! v)", steps)
    report = report_of(text)
    assert report.is_schedulable
    assert [chain.age for chain in report.chains] == [10 * MS]
    assert [loop.latency for loop in report.loops if loop.outputs] == [(1 * MS, 10 * MS)]
    assert simulated(text).age == age * MS


def test_an_immediate_output_does_not_wait_for_a_tick() -> None:
    text = program("5 ms", "5 ms immediate", "x ? v ; wait 500 us ; y ! v")
    (chain,) = report_of(text).chains
    assert (chain.age, chain.reaction) == (500 * US, 5500 * US)
    assert simulated(text)[:2] == (chain.age, chain.reaction)


def test_a_value_that_is_written_a_sample_later_at_a_tick_is_two_periods_old() -> None:
    text = program("5 ms", "5 ms offset 500 us", "x ? v ; wait 500 us ; y ! w ; w := v")
    (chain,) = report_of(text).chains
    seen = simulated(text)
    assert (seen.age, seen.reaction) == (10500 * US, 15500 * US)
    assert seen.age <= chain.age
    assert seen.reaction <= chain.reaction


@pytest.mark.parametrize(("micros", "age"), [(499, 500), (500, 5500), (501, 5500)])
def test_a_law_that_ends_at_the_tick_of_its_output_is_handed_over_a_period_later(micros: int, age: int) -> None:
    text = law("Law", f"{micros} us") + program("5 ms", "5 ms offset 500 us", "law").replace(
        "{ var v", "{ law : Law  x -> law.x  law.y -> y  var v"
    )
    report = report_of(text)
    assert report.is_schedulable
    assert [chain.age for chain in report.chains] == [age * US]
    network = with_bench(text.replace("y = 2 * x", "y = x"), ["x"], ["y"], "1 ms")
    with on_processor():
        assert seen_in(run(network, wcets(network).__getitem__, 60 * MS), "Main.y").age == age * US


def test_a_law_that_takes_its_whole_period_is_late() -> None:
    """What it computes from the sample of 5 ms is ready at 10 ms, after the tick, and is output at 15 ms."""
    text = loops_of(("a", "5 ms", "5 ms")).replace("y = 2 * x", "y = x")
    report = report_of(text)
    assert report.is_schedulable is False
    assert report.reason == (
        "`Main` is late: when every law takes its longest time, the sample of t = 5 ms is ready at t = 10 ms, when "
        "the next one comes"
    )
    assert by_name(report)["a"].slack == 0
    network = with_bench(text, ["x_a"], ["y_a"], "1 ms")
    found = diagnostic_of(timing_report(network), network.class_named(network.top).span)
    assert found is not None
    assert [label.message for label in found.labels] == ["`a` has 5 ms and may take as long"]
    with on_processor():
        assert seen_in(run(network, wcets(network).__getitem__, 60 * MS), "Main.y_a").age == 10 * MS
    assert report_of(loops_of(("a", "5 ms", "4999 us"))).is_schedulable


def test_a_sample_that_is_reached_when_the_next_one_comes_is_missed() -> None:
    """The loop that computes nothing runs after the slow one, which ends when its next sample overwrites the first."""
    text = loops_of(("slow", "10 ms", "1 ms"), ("quick", "1 ms", "0 us"))
    assert report_of(text).is_schedulable is None
    network = with_bench(text, ["x_slow", "x_quick"], ["y_slow", "y_quick"], "1 ms")
    with on_processor(), pytest.raises(AssertionError, match=r"a sample of Main\.x_quick was overwritten"):
        run(network, wcets(network).__getitem__, 60 * MS)
    assert report_of(text.replace("wcet 1 ms", "wcet 999999 ns")).is_schedulable


def is_late_in_a_run(network: Network, periods: dict[str, int], source: random.Random) -> bool:
    """Whether, in one of some runs, a law ends at the next sample of its loop or later, or a sample is missed."""
    stated, late = wcets(network), []

    def ended(path: str, began: int) -> None:
        release = began // periods[path] * periods[path]
        late.append(Processor.present >= release + periods[path])

    for times in (stated.__getitem__, lambda path: 250 * US * source.randint(0, stated[path] // (250 * US))):
        try:
            run(network, times, 20 * MS, ended)
        except AssertionError:
            return True
    return any(late)


def test_loops_that_end_at_each_others_ticks_are_late_only_where_that_is_said() -> None:
    answers: Counter[bool | None] = Counter()
    for seed in range(usual_or_thorough(20, 400)):
        source = random.Random(seed)
        names = "abc"[: source.randint(1, 3)]
        loops = [(name, source.choice([1, 2, 4]), 250 * source.randint(0, 6)) for name in names]
        text = loops_of(*((n, f"{t} ms", f"{w} us") for n, t, w in loops), order=source.choice(["||", "||>"]))
        network = with_bench(text, [f"x_{n}" for n in names], [f"y_{n}" for n in names], "1 ms")
        answer = timing_report(network).is_schedulable
        answers[answer] += 1
        with on_processor():
            is_late = is_late_in_a_run(network, {f"Main.{n}": t * MS for n, t, _ in loops}, source)
        assert answer is None or answer is not is_late, text
    assert min(answers[True], answers[False]) >= usual_or_thorough(6, 120)


def test_no_order_keeps_a_loop_that_computes_nothing_in_time_behind_a_long_step() -> None:
    report = report_of(loops_of(("slow", "10 ms", "3 ms"), ("quick", "1 ms", "0 us")))
    assert report.is_schedulable is None
    assert report.advice is None
    assert report.is_edf_feasible is None
