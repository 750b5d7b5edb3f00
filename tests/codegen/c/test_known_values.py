"""Values that are not computed again: constants of environments, and what laws compute from parameters alone."""

from __future__ import annotations

import re
from collections.abc import Mapping

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from tests.codegen.packages import network as model
from tests.codegen.packages import read

PROGRAM = """
process Follow {
  in  x : double @ 1 ms
  out u : double @ 1 ms
  communication { var v : double }
  composition { mu (x ? v ; u ! v) }
}
environment Plant for Follow {
  axle : Axle(mass = 2, lever = 3, spare = 4, grip = 0)
  u -> axle.u
  axle.x -> x
}
submodel Axle(mass: double, lever: double, spare: double, grip: double) {
  in  u : double
  out x : double
  state w : double = 0
  let moment = lever * u
  let unused = spare * u
  let inertia = mass * lever ^ 2
  der w = moment / inertia - w / mass - grip * w
  x = w
}
"""


@pytest.mark.parametrize("level", [0, 1])
def test_constants_of_environments_with_literal_values_are_constants_in_c(level: int) -> None:
    network = pipeline.build(SourceFile(name="follow.csp", text=PROGRAM), read).network
    assert network is not None
    package = pipeline.generate(network, read, "c", level)
    text, header = package["plant_environment.c"], package["plant_environment.h"]
    constants = dict(re.findall(r"^static const double (\w+) = ([\w.]+);", text, re.MULTILINE))
    assert constants == {"axle_mass": "2.0", "axle_lever": "3.0", "axle_grip": "0.0"}
    assert re.findall(r"double (\w+);", header) == ["x", "u", "axle_w", "axle_inertia"]
    assert "/ axle_mass" in text
    assert "csp_divide(csp, axle_moment, self->axle_inertia)" in text


def jiwy() -> Mapping[str, str]:
    return pipeline.generate(model("jiwy"), read, "c", 1)


def test_the_gains_of_jiwy_are_computed_with_once_for_each_change() -> None:
    text = jiwy()["joint_control.c"]
    (law,) = re.findall(r"^static void joint_control_homing_servo_calculate\(.*?^}$", text, re.MULTILINE | re.DOTALL)
    again = re.search(r"if \(self->homing_servo_changes != csp->changes\) \{(.*?)\n    \}\n", law, re.DOTALL)
    assert again is not None
    assert "csp_seconds(self->gains->tauD)" in again[1]
    assert "self->homing_servo_changes = csp->changes;" in again[1].splitlines()[-1]
    rest = law.replace(again[0], "")
    assert "csp_seconds" not in rest
    assert "pid_kp *" not in rest


def test_parameters_under_another_name_are_not_kept() -> None:
    header = jiwy()["joint_control.h"]
    assert "double homing_servo_pid_f;" in header
    assert "homing_servo_pid_kp" not in header
