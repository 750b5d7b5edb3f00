"""Loops as systems of python-control, with the sign convention of negative feedback."""

from __future__ import annotations

import math
from pathlib import Path

import control
import numpy
import pytest

import cspdiag
from tests.analyses.margins.programs import INTEGRATOR

MODELS = Path(__file__).parents[3] / "models"


@pytest.mark.parametrize("model", ["jiwy/jiwy.csp", "cascade/cascade.csp"])
def test_the_margins_of_python_control_are_those_that_are_reported(model: str) -> None:
    loops = cspdiag.load(MODELS / model).margins().loops
    assert len(loops) > 1
    for loop in loops:
        system, found = loop.to_control(), loop.margins
        gain, phase, modulus, _, crossover, _ = control.stability_margins(system, method="frd")
        assert found.is_stable
        assert gain == pytest.approx(found.gain, rel=1e-5)
        assert phase == pytest.approx(found.phase, abs=1e-4)
        assert modulus == pytest.approx(found.modulus, rel=1e-5)
        assert crossover == pytest.approx(found.crossover, rel=1e-4)


def test_negative_feedback_closes_the_loop() -> None:
    loops = cspdiag.load(MODELS / "jiwy/jiwy.csp").margins().loops
    for loop in loops:
        poles = abs(control.feedback(loop.to_control(), 1).poles())
        if loop.margins.drifts:
            poles = numpy.delete(poles, abs(poles - 1).argmin())
        assert max(poles) == pytest.approx(loop.margins.radius, rel=1e-9)


def test_an_integrator_with_a_gain_is_positive_in_the_open_loop() -> None:
    (loop,) = cspdiag.parse(INTEGRATOR.format(gain=2, latch="")).margins().loops
    system = loop.to_control()
    assert system.dt == 0.01
    slow = system(numpy.exp(1j * 0.1 * system.dt))
    assert slow == pytest.approx(2.0 / 0.1j, rel=1e-2)
    assert math.degrees(numpy.angle(slow)) == pytest.approx(-90, abs=0.2)


def test_names_are_those_of_the_program() -> None:
    system = cspdiag.load(MODELS / "jiwy/jiwy.csp").margins().loops[0].to_control()
    assert (system.name, system.input_labels, system.output_labels) == (
        "horizontal_alignL_velocity",
        ["e"],
        ["control"],
    )
    assert "plant:pan_speed" in system.state_labels
