"""What is measured: the formulas, by hand, and what is refused."""

from __future__ import annotations

from math import inf, nan, sqrt
from pathlib import Path

import pytest

import cspdiag
from cspdiag.model.types import DOUBLE
from cspdiag.sweep.measures import KINDS, Measure, Measures, Signal, measured
from tests.sweep.programs import HEATER

ROOT = Path(__file__).parents[2]
SECOND = 10**9


def of(
    kind: str, *values: tuple[float, float], end: float, target: float = 0.0, tolerance: float = 0.0
) -> float | None:
    """A measure of values at instants in seconds."""
    signal = Signal("x", "port", 0, DOUBLE, (), DOUBLE)
    measure = Measure(kind, kind, 0, None, False, target, tolerance, "")
    observations = [(round(time * SECOND), 0, value) for time, value in values]
    (found,) = measured(Measures((signal,), (measure,)), observations, round(end * SECOND))
    return found


STAIRS = (1.0, 2.0), (2.0, -4.0), (4.0, 1.0)
"""2 for one second, -4 for two, 1 for one."""


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        ("max", 2.0),
        ("min", -4.0),
        ("peak", 4.0),
        ("last", 1.0),
        ("mean", -5.0 / 4.0),
        ("integral", -5.0),
        ("rms", sqrt(37.0 / 4.0)),
    ],
)
def test_measures_of_stairs(kind: str, expected: float) -> None:
    assert of(kind, *STAIRS, end=5.0) == expected


def test_settling() -> None:
    assert of("settling", (0, 0), (1, 5), (2, 9), (3, 5.4), (4, 5), end=5, target=5, tolerance=0.5) == 3.0
    assert of("settling", (0, 0), (1, 5), (2, 9), end=5, target=5, tolerance=0.5) is None
    assert of("settling", (0, 5), end=5, target=5) == 0.0


def test_overshoot() -> None:
    assert of("overshoot", (0, 0), (1, 7), (2, 4), end=5, target=5) == 2.0
    assert of("overshoot", (0, 9), (1, 4), (2, 6), end=5, target=5) == 1.0
    assert of("overshoot", (0, 0), (1, 4), end=5, target=5) == 0.0
    assert of("overshoot", (0, 5), (1, 4), (2, 5.5), end=5, target=5) == 1.0


def test_the_last_value_of_an_instant_counts() -> None:
    assert of("max", (0, 1), (1, 9), (1, 3), end=2) == 3.0


@pytest.mark.parametrize("kind", KINDS)
def test_nothing_is_measured_of_nothing(kind: str) -> None:
    assert of(kind, end=1) is None


@pytest.mark.parametrize("kind", ["rms", "integral", "mean"])
def test_what_becomes_too_large_is_infinite(kind: str) -> None:
    large = 1e200 if kind == "rms" else 1e308
    assert of(kind, (1, large), (2, large), (3, large), (9, large), end=9) == inf


def test_what_is_not_a_number_is_nothing() -> None:
    assert of("mean", (1, inf), (2, -inf), end=9) is None
    assert of("last", (1, nan), end=9) is None


def test_a_difference_is_known_when_both_are() -> None:
    signals = tuple(Signal(name, "port", at, DOUBLE, (), DOUBLE) for at, name in enumerate("ab"))
    measure = Measure("m", "integral", 0, 1, True, 0.0, 0.0, "")
    observations = [(0, 0, 1.0), (SECOND, 1, 4.0), (2 * SECOND, 0, 9.0), (2 * SECOND, 1, 8.0)]
    assert measured(Measures(signals, (measure,)), observations, 5 * SECOND) == (3.0 + 3.0,)


@pytest.mark.parametrize(
    ("measure", "reason"),
    [
        ("power", "a measure is max(SIGNAL), min(SIGNAL)"),
        ("maxi(power)", "there is no measure 'maxi' (did you mean `max`?)"),
        ("xyz(power)", "integral(SIGNAL), settling(SIGNAL, TARGET, TOLERANCE) or overshoot(SIGNAL, TARGET))"),
        ("max(pwer)", "there is no port or state 'pwer' to measure (did you mean `power`?)"),
        ("max(room.mass)", "there is no port or state 'room.mass' to measure"),
        ("max(power, 3)", "it is max(SIGNAL)"),
        ("settling(power, 3)", "it is settling(SIGNAL, TARGET, TOLERANCE)"),
        ("settling(power, 3, -1)", "a tolerance is not negative"),
        ("overshoot(power, 3<V>)", "overshoot(power, 3<V>)"),
        ("max(power - power - power)", "of a signal, or of a difference of two"),
    ],
)
def test_what_cannot_be_measured_is_refused(measure: str, reason: str) -> None:
    with pytest.raises(cspdiag.MeasureError) as caught:
        cspdiag.parse(HEATER).sweep({"gain": "1:2:3"}, measure, until=1)
    assert reason in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_difference_has_one_unit() -> None:
    program = cspdiag.load(ROOT / "models/jiwy/jiwy.csp")
    with pytest.raises(cspdiag.MeasureError, match="their units are not the same"):
        program.sweep({}, "rms(pan.angle - pan.speed)", until=0)
