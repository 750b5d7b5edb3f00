"""The program itself on a processor that takes time: its laws never take longer than the bounds, and some take exactly
that long.
"""

from __future__ import annotations

import random
from collections.abc import Iterator

import pytest

import cspdiag
from cspdiag.analyses.timing.report.timing import timing_report
from tests.analyses.timing.processor import longest, on_processor, wcets, with_bench
from tests.analyses.timing.programs import US, by_name, law, loops_of
from tests.analyses.timing.random.compositions import composed
from tests.support.thorough import usual_or_thorough


@pytest.fixture(autouse=True)
def processor() -> Iterator[None]:
    with on_processor():
        yield


@pytest.mark.parametrize("order", ["||", "||>"])
def test_independent_loops_keep_their_bounds(order: str) -> None:
    source = random.Random(order)
    exact = programs = 0
    while programs < 12:
        names = "abcd"[: source.randint(2, 4)]
        chosen = [(name, source.choice([1, 2, 4, 5, 10]), source.randint(50, 900)) for name in names]
        text = loops_of(*((name, f"{period} ms", f"{work} us") for name, period, work in chosen), order=order)
        network = with_bench(text, [f"x_{n}" for n in names], [f"y_{n}" for n in names], "1 ms")
        report = timing_report(network)
        if not report.is_schedulable:
            continue
        programs += 1
        stated = wcets(network)
        periods = {f"Main.{name}": period * 1_000_000 for name, period, _ in chosen}
        bounds = {loop.task.name: loop.response or 0 for loop in report.loops}
        steady = longest(network, stated.__getitem__, periods, 45_000_000)
        varied = longest(network, lambda path: source.randint(1, stated[path]), periods, 45_000_000)  # noqa: B023
        for path, bound in bounds.items():
            assert 0 < steady[path] <= bound, text
            assert varied[path] <= bound, text
            exact += steady[path] >= bound - 1
    assert exact >= 10


def test_random_compositions_keep_their_bounds() -> None:
    compared = exact = 0
    for seed in range(usual_or_thorough(20, 200)):
        program = composed(seed)
        text = program.text()
        inputs = [*(name for name, _ in program.inputs), *program.events]
        network = with_bench(text, inputs, [name for name, _ in program.outputs], "1 ms")
        report = timing_report(network)
        assert not report.missing
        if not report.is_schedulable:
            continue
        bounds: dict[str, int] = {}
        for loop in report.loops:
            for leaf in loop.leaves:
                bounds[leaf] = max(bounds.get(leaf, 0), loop.response or 0)
        stated = wcets(network)
        steady = longest(network, stated.__getitem__, program.periods, 20_000_000)
        varied = longest(network, lambda path: program.source.randint(1, stated[path]), program.periods, 20_000_000)  # noqa: B023
        for found in (steady, varied):
            # What events and arrivals begin belongs to no sample.
            for path in bounds.keys() & found.keys():
                assert found[path] <= bounds[path], text
                compared += 1
                exact += found[path] >= bounds[path] - 1
    assert compared >= usual_or_thorough(40, 400)
    assert exact >= usual_or_thorough(3, 25)


def test_an_urgent_loop_waits_for_one_step_of_the_others_not_for_all_that_are_ready() -> None:
    others = [(name, "10 ms", "600 us") for name in "bcd"]
    text = loops_of(("a", "1 ms", "100 us"), *others, order="||>")
    network = with_bench(text, [f"x_{n}" for n in "abcd"], [f"y_{n}" for n in "abcd"], "1 ms")
    periods = {"Main.a": 1_000_000, **dict.fromkeys(("Main.b", "Main.c", "Main.d"), 10_000_000)}
    found = longest(network, wcets(network).__getitem__, periods, 45_000_000)
    bound = by_name(timing_report(network))["a"].response
    assert bound == 700 * US - 1
    assert found["Main.a"] <= bound


def test_the_cascade_keeps_its_bounds() -> None:
    from tests.models.programs import MODELS

    network = cspdiag.load(MODELS / "cascade" / "cascade.csp").network
    times = {"Cascade.inner.law": 20 * US, "Cascade.outer.law": 60 * US}
    bounds = {loop.task.name: loop.response or 0 for loop in timing_report(network, times).loops}
    periods = {"Cascade.inner.law": 100 * US, "Cascade.outer.law": 1000 * US}
    found = longest(network, times.__getitem__, periods, 20_000_000)
    assert all(0 < found[path] <= bound for path, bound in bounds.items())


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
      out w, v : double @ 1 ms
      communication {
        sense     : Sense
        computing : Computing
        log       : Log
        x -> sense.x
        sense.y -> passed : double -> computing.input
        computing.output -> v
        z -> log.x
        log.y -> w
      }
      composition { <order> }
    }
    """
)  # fmt: skip


@pytest.mark.parametrize(
    "order",
    ["mu sense || computing || mu log", "mu sense ||> mu log ||> computing", "mu log ||> computing ||> mu sense"],
)
def test_a_partner_keeps_the_bound_of_the_loop_that_waits_for_it(order: str) -> None:
    network = with_bench(PIPELINE.replace("<order>", order), ["x", "z"], ["w", "v"], "1 ms")
    loops = by_name(timing_report(network))
    periods = dict.fromkeys(("Main.sense", "Main.computing.compute", "Main.log"), 1_000_000)
    found = longest(network, wcets(network).__getitem__, periods, 20_000_000)
    assert max(found["Main.sense"], found["Main.computing.compute"]) <= (loops["sense"].response or 0)
    assert found["Main.log"] <= (loops["log"].response or 0)


def test_jiwy_keeps_its_bounds_in_all_modes() -> None:
    from tests.models.programs import MODELS

    network = cspdiag.load(MODELS / "jiwy" / "jiwy.csp").network
    stated = wcets(network)
    periods = {path: 2_000_000 if ".horizontal." in path else 1_000_000 for path in stated}
    bounds = {loop.task.name: loop.response or 0 for loop in timing_report(network).loops}
    found = longest(network, stated.__getitem__, periods, 4_000_000_000)
    assert len(found) >= 3
    assert all(found[path] <= bounds[path] for path in found)
