"""The largest sample period that keeps a margin."""

from __future__ import annotations

import math
from collections.abc import Mapping

import pytest

from cspdiag.analyses.margins.loops import reopen
from cspdiag.analyses.margins.open_loop import OpenLoop
from cspdiag.analyses.margins.period import RequiredMargin, Variant, largest_period, parse_margin, period_constants
from tests.analyses.margins.programs import INTEGRATOR, only_loop, program

GRAIN = 10_000
"""Four significant digits of a period of 10 ms, in nanoseconds."""


def variants_of(gain: float) -> Variant:
    loaded = program(INTEGRATOR, gain=gain, latch="")
    loop = only_loop(loaded)

    def variant(constants: Mapping[str, int]) -> OpenLoop | None:
        network = loaded.build(set={name: f"{value} ns" for name, value in constants.items()})
        return reopen(network, network.environments[0], loop)

    return variant


def test_the_constant_is_found() -> None:
    loaded = program(INTEGRATOR, gain=10.0, latch="")
    assert period_constants(loaded.network, only_loop(loaded).opened) == {"T": 10_000_000}


def test_a_period_that_is_a_number_in_the_text_has_none() -> None:
    text = INTEGRATOR.replace("@ T", "@ 10 ms")
    loaded = program(text, gain=10.0, latch="")
    assert period_constants(loaded.network, only_loop(loaded).opened) == {}


@pytest.mark.parametrize("gain", [3.0, 400.0])
def test_it_is_where_the_formula_says(gain: float) -> None:
    """K T = 1 is the limit of stability, K T = 1/2 leaves a gain margin of 2; the search starts from shorter and from
    longer periods.
    """
    present = {"T": 10_000_000}
    stable = largest_period(variants_of(gain), present, RequiredMargin("stable", 0))
    halved = largest_period(variants_of(gain), present, RequiredMargin("gain", 2.0))
    assert stable == pytest.approx(1e9 / gain, abs=GRAIN)
    assert halved == pytest.approx(0.5e9 / gain, abs=GRAIN)


def test_the_answer_keeps_what_is_wanted_and_the_next_period_does_not() -> None:
    variant = variants_of(7.0)
    for margin in (RequiredMargin("phase", 40.0), RequiredMargin("delay", 0.05), RequiredMargin("gain", 3.0)):
        found = largest_period(variant, {"T": 10_000_000}, margin)
        assert found is not None
        kept, lost = variant({"T": found}), variant({"T": found + GRAIN})
        assert kept is not None
        assert lost is not None
        assert margin.excess(kept) >= 0 > margin.excess(lost)


def test_few_periods_are_tried() -> None:
    tried: list[int] = []
    variant = variants_of(3.0)

    def counted(constants: Mapping[str, int]) -> OpenLoop | None:
        tried.append(constants["T"])
        return variant(constants)

    assert largest_period(counted, {"T": 10_000_000}, RequiredMargin("phase", 30.0)) is not None
    assert len(tried) == len(set(tried)) <= 14


def test_no_period_is_found_if_none_helps() -> None:
    assert largest_period(variants_of(-1.0), {"T": 10_000_000}, RequiredMargin("stable", 0)) is None


@pytest.mark.parametrize(
    ("text", "kind", "value"),
    [
        ("30deg", "phase", 30),
        ("30 deg", "phase", 30),
        ("6dB", "gain", 10**0.3),
        ("2", "gain", 2),
        ("5ms", "delay", 5e-3),
        ("stable", "stable", 0),
    ],
)
def test_margins_as_they_are_written(text: str, kind: str, value: float) -> None:
    found = parse_margin(text)
    assert found.kind == kind
    assert math.isclose(found.value, value, abs_tol=1e-12)


@pytest.mark.parametrize("text", ["", "deg", "-3dB", "a lot", "0", "1e99deg", "nan"])
def test_an_invalid_margin_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="a margin is"):
        parse_margin(text)
