"""Margins, compared with formulas, with eigenvalues, and with what the program itself does when it runs."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cspdiag.analyses.margins.linear import NotLinearError
from tests.analyses.margins.programs import INTEGRATOR, TWO_RATES, loops, only_loop, program

T = 0.01


def test_a_latched_output_costs_a_period() -> None:
    """L = K T / (z (z - 1)) is stable below K T = 1; its phase is -90° - 1.5 wT."""
    found = only_loop(program(INTEGRATOR, gain=10.0, latch="")).margins
    crossover = 2 / T * math.asin(10 * T / 2)
    lag = math.pi / 2 - 1.5 * crossover * T
    assert found.is_stable
    assert found.gain == pytest.approx(1 / (10 * T), rel=1e-3)
    assert found.crossover == pytest.approx(crossover, rel=1e-3)
    assert found.phase == pytest.approx(math.degrees(lag), abs=0.01)
    assert found.delay == pytest.approx(lag / crossover, rel=1e-3)
    assert found.lowest_gain == 0


def test_an_immediate_output_costs_none() -> None:
    """L = K T / (z - 1) is stable below K T = 2, where it oscillates at half the sample frequency."""
    found = only_loop(program(INTEGRATOR, gain=10.0, latch="immediate")).margins
    assert found.gain == pytest.approx(2 / (10 * T), rel=1e-6)
    assert found.phase_crossover == pytest.approx(math.pi / T)
    assert found.radius == pytest.approx(1 - 10 * T)


def test_an_unstable_loop_says_what_is_missing() -> None:
    found = only_loop(program(INTEGRATOR, gain=125.0, latch="")).margins
    assert not found.is_stable
    assert found.gain == pytest.approx(0.8, rel=1e-3)
    assert found.phase < 0
    assert found.delay == 0


def test_positive_feedback_is_unstable() -> None:
    assert not only_loop(program(INTEGRATOR, gain=-1.0, latch="")).margins.is_stable


def envelope(text: str, port: str, until: str, **values: object) -> tuple[float, float]:
    """The largest absolute value of a port in the second and in the last quarter of a run."""
    run = program(text, **values).run(until=until)
    signal = np.abs(run[port])
    quarter = len(signal) // 4
    return float(np.max(signal[quarter : 2 * quarter])), float(np.max(signal[-quarter:]))


def test_an_output_with_an_offset_costs_that() -> None:
    """L = K ((T - d) z + d) / (z (z - 1)): z = -1 is a root of 1 + L at K = 2 / (T - 2 d), of modulus below 1."""
    found = only_loop(program(INTEGRATOR, gain=10.0, latch="offset 2 ms")).margins
    assert found.gain == pytest.approx(2 / (T - 2 * 0.002) / 10, rel=1e-3)
    without = only_loop(program(INTEGRATOR, gain=10.0, latch="immediate")).margins
    latched = only_loop(program(INTEGRATOR, gain=10.0, latch="")).margins
    assert found.delay == pytest.approx(latched.delay + T - 0.002, rel=0.02)
    assert found.delay == pytest.approx(without.delay - 0.002, rel=0.02)


def test_offsets_of_inputs_are_refused() -> None:
    text = INTEGRATOR.replace("in  y : double @ T", "in  y : double @ T offset 2 ms", 1)
    with pytest.raises(NotLinearError, match="the samples of `y` have an offset"):
        loops(program(text, gain=10.0, latch=""))


@pytest.mark.parametrize("latch", ["", "immediate", "offset 2 ms", "offset 7 ms"])
def test_the_program_itself_loses_stability_at_the_gain_margin(latch: str) -> None:
    margin = only_loop(program(INTEGRATOR, gain=10.0, latch=latch)).margins.gain
    early, late = envelope(INTEGRATOR, "y", "6 s", gain=9.9 * margin, latch=latch)
    assert late < 0.7 * early
    early, late = envelope(INTEGRATOR, "y", "6 s", gain=10.1 * margin, latch=latch)
    assert late > 1.5 * early


@pytest.mark.parametrize("order", ["inner ||> (mu outer)", "(mu outer) ||> inner", "inner || (mu outer)"])
def test_two_rates_lose_stability_at_the_gain_margin_too(order: str) -> None:
    report = loops(program(TWO_RATES, gain=1.0, order=order))
    by_name = {loop.opened.cut.name: loop for loop in report.loops}
    assert set(by_name) == {"inner.law.u", "outer.reference"}
    outer = by_name["outer.reference"]
    assert outer.opened.laws == ("Main.outer", "Main.inner.law")
    assert by_name["inner.law.u"].opened.laws == ("Main.inner.law",)
    margin = outer.margins.gain
    assert outer.margins.is_stable
    assert 1 < margin < 1000
    early, late = envelope(TWO_RATES, "angle", "3 s", gain=0.97 * margin, order=order)
    assert late < 0.8 * early
    early, late = envelope(TWO_RATES, "angle", "3 s", gain=1.03 * margin, order=order)
    assert late > 1.2 * early


def test_gain_margin_is_where_the_eigenvalues_leave_the_unit_circle() -> None:
    for gain in (0.5, 1.0, 2.0):
        text = {"order": "inner ||> (mu outer)"}
        (margin,) = {
            loop.margins.gain
            for loop in loops(program(TWO_RATES, gain=gain, **text)).loops
            if "outer" in loop.opened.cut.law
        }
        radius = [
            loop.margins.radius
            for factor in (0.999, 1.001)
            for loop in loops(program(TWO_RATES, gain=gain * margin * factor, **text)).loops
            if "outer" in loop.opened.cut.law
        ]
        assert radius[0] < 1 < radius[1]


NOT_LINEAR = INTEGRATOR.replace("u = -({gain}) * y", "u = limit(-({gain}) * quantize(y, 0.001), -1, 1)")


def test_what_is_not_linear_is_named_with_its_place() -> None:
    loop = only_loop(program(NOT_LINEAR, gain=10.0, latch=""))
    assert loop.margins == only_loop(program(INTEGRATOR, gain=10.0, latch="")).margins
    reported = {part.what: part.span for part in loop.simplifications}
    assert set(reported) == {"the limit counts as not reached", "quantization is taken as its mean, without steps"}
    assert {span.line for span in reported.values() if span is not None} == {7}


DRY = INTEGRATOR.replace(
    "  der x = u / 1<s>\n",
    "  state v : double = 0\n  der x = v / 1<s>\n  der v = if v == 0 then 0 else (u - 2 * v - sign(v)) / 1<s>\n",
)


def test_a_plant_that_sticks_is_linearized_in_motion() -> None:
    loop = only_loop(program(DRY, gain=1.0, latch=""))
    assert loop.point == {"plant.v": 0.1}
    assert loop.margins.is_stable


def test_the_operating_point_can_be_chosen() -> None:
    curved = INTEGRATOR.replace("  y = x\n", "  y = x * x\n")
    for at in (0.5, 2.0):
        (loop,) = loops(program(curved, gain=10.0, latch=""), point={"plant.x": at}).loops
        assert loop.margins.gain == pytest.approx(1 / (10 * T * 2 * at), rel=1e-3)


def test_bodies_in_other_languages_are_refused_with_their_place() -> None:
    text = INTEGRATOR.replace(
        "submodel Law {{\n  in  y : double\n  out u : double\n  u = -({gain}) * y\n}}",
        'submodel Law python "law.py:Law" {{\n  in  y : double\n  out u : double\n}}',
    )
    report = loops(program(text, latch=""))
    assert report.loops == ()
    (refusal,) = report.refusals
    assert refusal.law == "Main.law"
    assert "python" in refusal.reason
    assert refusal.span is not None
    assert refusal.span.line == 4


def test_a_plant_in_another_language_is_refused() -> None:
    text = INTEGRATOR.replace(
        "submodel Plant {{\n  in  u : double\n  out y : double\n"
        "  state x : double = 1\n  der x = u / 1<s>\n  y = x\n}}",
        'submodel Plant python "plant.py:Plant" {{\n  in  u : double\n  out y : double\n}}',
    )
    with pytest.raises(NotLinearError, match="cannot be linearized"):
        loops(program(text, gain=1.0, latch=""))


SCHEDULED = (
    INTEGRATOR.replace(
        "  in  y : double\n  out u : double\n  u = -({gain}) * y",
        "  in  y : double\n  in  gain, scale : double = 5\n  out u : double\n  u = -gain * scale * y", 1,
    )
    .replace("    law : Law\n", "    law : Law\n    var gain : double = 2\n    gain -> law.gain\n")
)  # fmt: skip


def test_constant_inputs_have_their_values_from_the_beginning() -> None:
    loop = only_loop(program(SCHEDULED, latch=""))
    assert loop.margins == only_loop(program(INTEGRATOR, gain=10.0, latch="")).margins


def test_a_plant_that_steps_much_more_often_than_the_law() -> None:
    """A filter f' = a f + (1 - a) u on a grid of 1 us: over a period T it covers the fraction 1 - a^n of a step, and L
    = K (1 - a^n) / (z (z - a^n)).
    """
    pole = 0.9999
    text = INTEGRATOR.replace("der x = u / 1<s>", f"next x = {pole} * x + {1 - pole:.4f} * u")
    text = text.replace("environment Bench for Main {{", "environment Bench for Main step 1 us {{")
    found = only_loop(program(text, gain=0.5, latch="")).margins
    way = 1 - pole**10_000
    assert found.is_stable
    assert found.gain == pytest.approx(1 / (0.5 * way), rel=1e-4)
