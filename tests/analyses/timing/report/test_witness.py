"""Loops whose bounds are longer than their periods are reported as late only if a run shows it."""

from __future__ import annotations

import random
from collections.abc import Iterator
from contextlib import suppress

import pytest

from cspdiag.analyses.timing.report.diagnostics import diagnostic_of
from cspdiag.analyses.timing.report.render_text import table
from cspdiag.analyses.timing.report.timing import timing_report
from cspdiag.network.ir.network import Network
from tests.analyses.timing.processor import Processor, on_processor, run, wcets, with_bench
from tests.analyses.timing.programs import MS, US, law, loops_of, network_of, report_of


@pytest.fixture(autouse=True)
def processor() -> Iterator[None]:
    with on_processor():
        yield


def ends_of(network: Network, times: dict[str, int]) -> dict[str, list[int]]:
    """When each law has computed, until the program ends."""
    ends: dict[str, list[int]] = {path: [] for path in times}
    # It ends with `Timeout` if a sample arrives before the previous one has been taken.
    with suppress(AssertionError):
        run(network, times.__getitem__, 60 * MS, lambda path, _: ends[path].append(Processor.present))
    return ends


def test_the_reported_sample_is_late_in_a_run() -> None:
    source = random.Random(5)
    shown = missed = 0
    while shown < 25:
        names = "abc"[: source.randint(2, 3)]
        loops = [(n, source.choice([1, 2, 4, 5]), source.randint(100, 1500)) for n in names]
        order = source.choice(["||", "||>"])
        text = loops_of(*((n, f"{period} ms", f"{work} us") for n, period, work in loops), order=order)
        network = with_bench(text, [f"x_{n}" for n in names], [f"y_{n}" for n in names], "1 ms")
        witness = timing_report(network).witness
        if witness is None:
            continue
        shown += 1
        due = witness.release + next(period for n, period, _ in loops if f"Main.{n}" == witness.thread) * MS
        ends = ends_of(network, wcets(network))[witness.thread]
        if witness.end is None:
            missed += 1
            assert not any(witness.release < end <= due for end in ends), text
        else:
            assert witness.end > due
            assert witness.end in ends, text
    assert 0 < missed < shown


def test_a_bound_that_no_known_run_reaches_refutes_nothing() -> None:
    """The slow loop begins only when the fast one has just been served, which a bound for all phases does not know."""
    text = loops_of(("fast", "1 ms", "300 us"), ("slow", "10 ms", "800 us"), order="||>")
    report = report_of(text)
    assert report.loops[0].response == 1100 * US - 1
    assert report.is_schedulable is None
    assert table(report).startswith("NOT PROVED: Main: `fast` may not be ready before the next sample, though response")
    network = network_of(text)
    found = diagnostic_of(report, network.class_named(network.top).span)
    assert found is not None
    assert found.code == "E1107"
    assert [label.message for label in found.labels] == ["up to 1.1 ms of 1 ms"]


def test_a_sample_that_takes_longer_than_its_period_is_late_in_every_mode() -> None:
    text = (
        law("Law", "1200 us") +
        """
        process Main {
          in  x  : double @ 1 ms
          in  go : int
          out y  : double @ 1 ms
          communication {
            law : Law
            var pressed : int = 0
            x -> law.x
            law.y -> y
          }
          composition { go ? pressed -> (mu law catch Timeout -> skip) }
        }
        """
    )  # fmt: skip
    report = report_of(text)
    assert report.is_schedulable is False
    assert report.reason == "`law` cannot always be ready before the next sample: there is more work than time"


def test_the_longer_of_two_paths_need_not_be_followed() -> None:
    text = (
        law("Short", "100 us") + law("Long", "1200 us") +
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
    assert report_of(text).is_schedulable is None
