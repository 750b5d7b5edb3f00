"""JIWY loses stability between sample periods of 5 and 10 ms, and the margins show it without a run."""

from __future__ import annotations

from functools import cache

import pytest

import cspdiag
from cspdiag.analyses.margins.loops import AnalysedLoop, analyse_loops
from tests.models.programs import MODELS

SERVOS = ("horizontal.motionControl.servo.control", "vertical.motionControl.servo.control")


@cache
def jiwy(period: str | None, only: str | None = None) -> dict[str, AnalysedLoop]:
    settings = {} if period is None else {"Tsh": period, "Tsv": period}
    network = cspdiag.load(MODELS / "jiwy" / "jiwy.csp").build(set=settings)
    report = analyse_loops(network, network.environments[0], only=only)
    assert report.refusals == ()
    return {loop.opened.cut.name: loop for loop in report.loops}


def test_every_mode_of_both_joints_has_a_loop() -> None:
    laws = ("alignL.velocity", "alignR.velocity", "motionControl.servo", "homing.servo")
    assert set(jiwy(None)) == {f"{joint}.{law}.control" for joint in ("horizontal", "vertical") for law in laws}
    assert all(loop.margins.is_stable for loop in jiwy(None).values())


@pytest.mark.parametrize("servo", SERVOS)
def test_stability_is_lost_between_5_and_10_ms(servo: str) -> None:
    assert jiwy("5 ms", "motionControl")[servo].margins.is_stable
    assert not jiwy("10 ms", "motionControl")[servo].margins.is_stable


def test_alignment_stays_stable_at_10_ms_as_it_does_in_the_simulation() -> None:
    assert all(loop.margins.is_stable for loop in jiwy("10 ms", "alignL").values())


@pytest.mark.parametrize("servo", SERVOS)
def test_margins_shrink_with_the_period(servo: str) -> None:
    assert (
        jiwy(None)[servo].margins.phase
        > jiwy("5 ms", "motionControl")[servo].margins.phase
        > 0
        > jiwy("10 ms", "motionControl")[servo].margins.phase
    )


def test_the_friction_that_holds_the_joint_is_reported() -> None:
    assert jiwy(None)[SERVOS[0]].point == {"pan.speed": 0.1}
    assert jiwy(None)[SERVOS[1]].point == {"tilt.speed": 0.1}
