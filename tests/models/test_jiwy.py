"""The figures that a run of JIWY must reach, measured on what the ports recorded."""

from __future__ import annotations

import itertools
import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import cspdiag
from cspdiag.simulate.result import Run
from tests.models.programs import MODELS, run

REACH = 1.25
"""The angle in rad that corresponds to the full stick."""


@dataclass(frozen=True)
class Joint:
    """A joint, its end stops in rad as the encoder counts them from where it was switched on, and the tolerances that
    its friction requires.
    """

    name: str
    left: float
    right: float
    settled: float
    homed: float

    @property
    def centre(self) -> float:
        return (self.left + self.right) / 2


PAN = Joint("horizontal", -1.62 - 0.3, 1.50 - 0.3, settled=0.010, homed=0.005)
TILT = Joint("vertical", -2.05 + 0.4, 1.85 + 0.4, settled=0.015, homed=0.020)
JOINTS = pytest.mark.parametrize("joint", [PAN, TILT], ids=lambda joint: joint.name)


@cache
def bench() -> Run:
    return run("jiwy/jiwy.csp", until="20 s")


@cache
def bench_at_10_ms() -> Run:
    return run("jiwy/jiwy.csp", until="20 s", set={"Tsh": "10 ms", "Tsv": "10 ms"})


def span_of(result: Run, joint: Joint, mode: str) -> tuple[float, float]:
    """When a mode of a joint began and ended, in seconds."""
    path = f"Jiwy.{joint.name}.{mode}"
    (activity,) = [activity for activity in result.activities if activity.path == path]
    assert activity.end is not None
    return activity.start / 1e9, activity.end / 1e9


def angle_at(result: Run, joint: Joint, instant: float) -> float:
    """The value of the encoder at an instant."""
    time, angle = result.time(f"feedback_{joint.name}"), result[f"feedback_{joint.name}"]
    return float(angle[np.flatnonzero(time <= instant + 1e-9)[-1]])


def found_stops(result: Run, joint: Joint) -> tuple[float, float]:
    """``leftmax`` and ``rightmax``: where the joint was when the alignment modes ended."""
    return tuple(angle_at(result, joint, span_of(result, joint, mode)[1]) for mode in ("alignL", "alignR"))  # type: ignore[return-value]


def steps(result: Run, joint: Joint) -> list[tuple[float, float, float, float]]:
    """Steps of the set-point by 0.5 rad: begin, end, old and new value relative to the centre."""
    time, stick = result.time(f"joystick_{joint.name}"), result[f"joystick_{joint.name}"]
    changes = [int(k) + 1 for k in np.flatnonzero(np.diff(stick))]
    ends = [*(float(time[k]) for k in changes[1:]), float(time[-1])]
    return [
        (float(time[k]), end, REACH * float(stick[k - 1]), REACH * float(stick[k]))
        for k, end in zip(changes, ends, strict=True)
        if abs(abs(stick[k] - stick[k - 1]) * REACH - 0.5) < 1e-9
    ]


def settling(result: Run, joint: Joint, step: tuple[float, float, float, float]) -> tuple[float, float]:
    """Time in seconds until the joint stays within the tolerance of a step, and the overshoot as a fraction of the
    step.
    """
    begin, end, old, new = step
    left, right = found_stops(result, joint)
    time, angle = result.time(f"feedback_{joint.name}"), result[f"feedback_{joint.name}"]
    during = (time >= begin) & (time < end)
    error = angle[during] - ((left + right) / 2 + new)
    outside = np.flatnonzero(np.abs(error) > joint.settled)
    last = begin if len(outside) == 0 else float(time[during][outside[-1]])
    return last - begin, float(np.max(error * np.sign(new - old))) / abs(new - old)


def test_program_terminates_by_itself() -> None:
    assert bench().outcome.ended == "terminated"
    assert not any(bench().outcome.missed.values())


@JOINTS
def test_modes_follow_each_other(joint: Joint) -> None:
    spans = [span_of(bench(), joint, mode) for mode in ("alignL", "alignR", "motionControl", "homing")]
    assert spans[0][0] == 0
    assert all(before[1] == after[0] for before, after in itertools.pairwise(spans))


@JOINTS
def test_end_stops_and_centre_are_found_within_3_mrad(joint: Joint) -> None:
    left, right = found_stops(bench(), joint)
    assert abs(left - joint.left) < 0.003
    assert abs(right - joint.right) < 0.003
    assert abs((left + right) / 2 - joint.centre) < 0.003


@JOINTS
def test_no_stop_is_hit_faster_than_1_5_rad_per_second(joint: Joint) -> None:
    time, angle = bench().time(f"feedback_{joint.name}"), bench()[f"feedback_{joint.name}"]
    aligned = span_of(bench(), joint, "alignR")[1]
    window = round(0.01 / float(time[1] - time[0]))
    speed = np.abs(angle[window:] - angle[:-window]) / (time[window:] - time[:-window])
    near = (angle < joint.left + 0.02) | (angle > joint.right - 0.02)
    assert np.max(speed[near[:-window] & (time[window:] <= aligned)]) < 1.5
    assert not np.any(near[time > aligned + 0.2])


@JOINTS
def test_step_of_half_a_radian_settles_within_300_ms(joint: Joint) -> None:
    found = [settling(bench(), joint, step) for step in steps(bench(), joint)]
    assert len(found) == 4
    assert max(time for time, _ in found) < 0.3
    assert max(overshoot for _, overshoot in found) < 0.1


@JOINTS
def test_joint_homes_to_its_centre(joint: Joint) -> None:
    left, right = found_stops(bench(), joint)
    begin, end = span_of(bench(), joint, "homing")
    assert abs(angle_at(bench(), joint, begin) - (left + right) / 2) > 0.2
    assert abs(angle_at(bench(), joint, end) - (left + right) / 2) < joint.homed


@JOINTS
def test_output_ends_at_zero_volts(joint: Joint) -> None:
    assert bench()[f"control_{joint.name}"][-1] == 0


@JOINTS
def test_every_mode_leaves_with_zero_volts(joint: Joint) -> None:
    time, voltage = bench().time(f"control_{joint.name}"), bench()[f"control_{joint.name}"]
    period = float(time[1] - time[0])
    for mode in ("alignL", "alignR", "motionControl"):
        end = span_of(bench(), joint, mode)[1]
        (written,) = voltage[np.abs(time - (end + period)) < period / 4]
        assert written == 0


@JOINTS
def test_button_ends_motion_at_the_instant_it_is_pressed(joint: Joint) -> None:
    pressed = float(bench().time("joystick_buttons")[0])
    assert bench()["joystick_buttons"][0] == 2
    assert span_of(bench(), joint, "motionControl")[1] == pytest.approx(pressed, abs=1e-9)


@JOINTS
def test_button_goes_before_the_sample_of_the_same_instant(joint: Joint) -> None:
    pressed = float(bench().time("joystick_buttons")[0])
    name = f"feedback_{joint.name}"
    (sample,) = np.flatnonzero(np.isclose(bench().time(name), pressed, atol=1e-9))
    assert bench().unread(name)[sample]
    assert not bench().unread(name)[sample - 1]


@JOINTS
def test_ten_milliseconds_alone_break_the_loops(joint: Joint) -> None:
    result = bench_at_10_ms()
    left, right = found_stops(result, joint)
    assert abs((left + right) / 2 - joint.centre) < 0.003
    found = [settling(result, joint, step) for step in steps(result, joint)]
    assert len(found) == 4
    assert min(time for time, _ in found) > 0.3
    assert result.outcome.ended == "terminated"
    assert result[f"control_{joint.name}"][-1] == 0


@JOINTS
def test_a_worn_machine_is_still_aligned_and_homed(joint: Joint) -> None:
    start = {"horizontal": 1.4, "vertical": -2.0}[joint.name] - {"horizontal": 0.3, "vertical": -0.4}[joint.name]
    result = run("jiwy/jiwy.csp", environment="Worn", until="25 s")
    left, right = found_stops(result, joint)
    assert abs(left - (joint.left - start)) < 0.003
    assert abs(right - (joint.right - start)) < 0.003
    assert span_of(result, joint, "motionControl")[1] == pytest.approx(15)
    assert abs(angle_at(result, joint, span_of(result, joint, "homing")[1]) - (left + right) / 2) < joint.homed
    assert result.outcome.ended == "terminated"


def test_alignment_without_an_end_stop_releases_both_motors_and_fails() -> None:
    result = run("jiwy/jiwy.csp", environment="Bench", until="1 s", set={"horizontal.alignL.patience": "100 ms"})
    assert result.outcome.ended == "failed"
    assert type(result.outcome.error).__name__ == "ModeFailed"
    assert result["control_horizontal"][-1] == 0
    assert result["control_vertical"][-1] == 0


def test_a_missed_sample_leaves_with_zero_volts(tmp_path: Path) -> None:
    for file in (MODELS / "jiwy").glob("*.csp"):
        text = file.read_text(encoding="utf-8")
        (tmp_path / file.name).write_text(
            text.replace("[]> feedback -> servo)", "[]> feedback -> (servo ; wait 5 ms))"), encoding="utf-8"
        )
    result = cspdiag.load(tmp_path / "jiwy.csp").run(until="20 s")
    began, ended = span_of(result, PAN, "motionControl")
    assert ended - began < 0.02
    assert result.outcome.ended == "failed"
    assert type(result.outcome.error).__name__ == "ModeFailed"
    assert result["control_horizontal"][-1] == 0
    assert result["control_vertical"][-1] == 0


def test_description_shows_the_program_and_its_code_as_they_are() -> None:
    description = (MODELS / "jiwy" / "README.md").read_text(encoding="utf-8")
    program = (MODELS / "jiwy" / "jiwy.csp").read_text(encoding="utf-8")
    code = cspdiag.load(MODELS / "jiwy" / "jiwy.csp").compile()["jiwy/motion_control.py"]
    (composition,) = re.findall(r"^```csp\n(.*?)^```$", description, re.MULTILINE | re.DOTALL)
    (excerpt,) = re.findall(r"^```python\n(.*?)^```$", description, re.MULTILINE | re.DOTALL)
    assert composition in program.replace("\n  ", "\n")
    assert without_places(excerpt) in without_places(code)


def without_places(code: str) -> str:
    """Generated code without its comments, which name lines of the program."""
    return re.sub(r"  # .*", "", code)
