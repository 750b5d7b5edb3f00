"""Linear operators against python-control."""

from __future__ import annotations

import math
from typing import Any

import control
import numpy
import pytest

from tests.network.submodels.compiled import MS, instance

METHODS = ("tustin", "zoh", "euler", "backward")
CONTROL = {"tustin": "tustin", "zoh": "zoh", "euler": "euler", "backward": "backward_diff"}
SAMPLE = 2 * MS
INPUT = [math.sin(0.7 * k) + (1.0 if k > 3 else 0.0) for k in range(60)]


def response(text: str, **arguments: Any) -> list[float]:
    block = instance(text, "Block", SAMPLE, **arguments)
    return [block.sample(x=x)["y"] for x in INPUT]


def reference(numerator: list[float], denominator: list[float], method: str) -> Any:
    sampled = control.sample_system(control.tf(numerator, denominator), SAMPLE / 1e9, CONTROL[method])
    return control.forced_response(sampled, U=INPUT).outputs


def block(equation: str, parameters: str = "") -> str:
    return f"submodel Block{parameters} {{ in x : double out y : double {equation} }}"


@pytest.mark.parametrize("method", METHODS)
def test_lag_is_discretized_as_by_python_control(method: str) -> None:
    found = response(block(f"y = lag(x, tau, method = {method})", "(tau: time)"), tau=15 * MS)
    assert found == pytest.approx(reference([1], [0.015, 1], method), abs=1e-12)


@pytest.mark.parametrize("method", METHODS)
def test_integral_is_discretized_as_by_python_control(method: str) -> None:
    found = response(block(f"y = integral(x, 0<s>, method = {method}) / 1<s>"))
    assert found == pytest.approx(reference([1], [1, 0], method), abs=1e-12)


@pytest.mark.filterwarnings("ignore::scipy.signal.BadCoefficients")
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    ("numerator", "denominator"),
    [
        ([1.0], [0.01, 1.0]),
        ([0.1, 1.0], [0.01, 1.0]),
        ([3.0], [2.0]),
        ([1.0], [1e-4, 1e-2, 1.0]),
        ([2e-4, 0.0, 1.0], [1e-4, 1e-2, 1.0]),
        ([1.0, 2.0], [1e-6, 3e-4, 2e-2, 1.0]),
        ([1.0], [1e-8, 1e-6, 4e-4, 2e-2, 1.0]),
    ],
)
def test_transfer_is_discretized_as_by_python_control(
    method: str, numerator: list[float], denominator: list[float]
) -> None:
    found = response(block(f"y = transfer({numerator}, {denominator}, x, method = {method})"))
    expected = reference(numerator, denominator, method)
    assert found == pytest.approx(expected, rel=1e-6, abs=1e-7 * float(numpy.abs(expected).max()))


@pytest.mark.parametrize("method", ["tustin", "zoh", "euler"])
def test_statespace_is_discretized_as_by_python_control(method: str) -> None:
    text = block(f"y = statespace([[0, 1], [-400, -12]], [[0], [1]], [[1, 0.2]], [[0.5]], x, method = {method})")
    system = control.ss([[0, 1], [-400, -12]], [[0], [1]], [[1, 0.2]], [[0.5]])
    sampled = control.sample_system(system, SAMPLE / 1e9, CONTROL[method])
    expected = control.forced_response(sampled, U=INPUT).outputs
    assert response(text) == pytest.approx(expected, abs=1e-12)


def test_statespace_backward_is_the_implicit_euler_method() -> None:
    found = response(block("y = statespace([[-20]], [[20]], [[1]], [[0]], x, method = backward)"))
    assert found == pytest.approx(reference([1], [0.05, 1], "backward"), abs=1e-12)


def test_derivative_is_the_backward_difference() -> None:
    found = response(block("y = derivative(x) * 1<s>"))
    expected = numpy.diff([0.0, *INPUT]) / (SAMPLE / 1e9)
    assert found == pytest.approx(expected)


def test_pre_and_delay_shift_by_samples() -> None:
    assert response(block("y = pre(x, 7)")) == [7.0, *INPUT[:-1]]
    assert response(block("y = delay(x, 1, 7)")) == [7.0, *INPUT[:-1]]
    assert response(block("y = delay(x, n, 7)", "(n: int)"), n=4) == [7.0] * 4 + INPUT[:-4]


def test_the_initial_value_of_an_integral_counts() -> None:
    assert response(block("y = integral(x - x, 3<s>) / 1<s>")) == [3.0] * len(INPUT)


def test_operators_inside_expressions_have_states_of_their_own() -> None:
    found = response(block("y = lag(x, 10 ms) - 2 * lag(x, 10 ms) + pre(pre(x, 0), 0)"))
    once = response(block("y = lag(x, 10 ms)"))
    assert found == pytest.approx([b - a for a, b in zip(once, [0.0, 0.0, *INPUT[:-2]], strict=True)])


def test_a_fast_sampled_filter_of_high_order_stays_accurate() -> None:
    # Fourth order, 10 Hz bandwidth at 100 kHz: coefficients in z would lose all precision.
    a = 1 / (2 * math.pi * 10)
    poly = numpy.poly([-1 / a] * 4) * a**4
    text = block(f"y = transfer([1], {[float(c) for c in poly]}, x)")
    filter_ = instance(text, "Block", 10_000)
    for _ in range(30_000):
        found = filter_.sample(x=1.0)["y"]
    t = 30_000 * 1e-5 / a
    expected = 1 - math.exp(-t) * sum(t**k / math.factorial(k) for k in range(4))
    assert found == pytest.approx(expected, abs=1e-4)


def test_binary32_operators_compute_in_binary32() -> None:
    text = "submodel Block { in x : float out y : float y = lag(x, 10 ms) }"
    found = response(text)
    assert found == pytest.approx(response(block("y = lag(x, 10 ms)")), abs=1e-5)
    assert all(value == numpy.float32(value) for value in found)
