"""Environments become one system, with drivers next to it."""

from __future__ import annotations

import re

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.base.sources import read_source
from cspdiag.network.ir.network import SubmodelClass
from cspdiag.semantics.equations.laws import Law
from tests.network.submodels.compiled import MS, environment

PROGRAM = """
process Servo(T: time = 4 ms) {
  in  angle   : double<rad> @ T
  in  button  : int
  in  level[2] : double @ 6 ms
  out voltage : double<V> @ T

  communication {
    var last    : double<rad> = 0
    var pressed : int = 0
    var low     : double = 0
  }
  composition {
    (mu (angle ? last ; voltage ! 1<V>)) || (mu (button ? pressed)) || (mu (seq i < 2 : level[i] ? low))
  }
}

submodel Friction(coefficient: double<1/s>) {
  in  speed : double<rad/s>
  out brake : double<rad/s^2>
  brake = coefficient * speed
}

/// A motor.
submodel Motor(gain: double<rad/V/s^2> = 2<rad/V/s^2>) step 500 us {
  in  voltage : double<V>
  out angle   : double<rad>
  out speed   : double<rad/s>

  friction : Friction(coefficient = 3<1/s>)
  state theta : double<rad> = 0
  state omega : double<rad/s> = 0
  friction.speed = omega
  der theta = omega
  der omega = gain * voltage - friction.brake
  angle = theta
  speed = omega
}

submodel Finger {
  out button : int
  button = if time < 1 s then 0 else 1
}

submodel Level(value: double) {
  out y : double
  y = integral(value, 0<s>) / 1<s>
}

driver Stick(port: text = "/dev/stick", scale: double = 2) python "stick.py:Stick" {
  out x : int
  out levels[2] : double
}

environment Bench for Servo {
  motor  : Motor
  finger : Finger
  tank[i < 2] : Level(value = double(i))

  voltage       -> motor.voltage
  motor.angle   -> angle
  finger.button -> button
  for i < 2 { tank[i].y -> level[1 - i] }
}

environment Hands for Servo step 1 ms on miss count {
  motor : Motor(gain = 5<rad/V/s^2>)
  stick : Stick(port = "left")

  voltage      -> motor.voltage
  motor.angle  -> angle
  stick.x      -> button
  stick.levels -> level
}
"""


def system(name: str, **overrides: float) -> SubmodelClass:
    found = environment(PROGRAM, name, {key.replace("__", "."): value for key, value in overrides.items()}).system
    assert found is not None
    return found


def test_the_programs_outputs_are_inputs_of_the_system_and_its_inputs_are_outputs() -> None:
    bench = system("Bench")
    assert [(p.direction, p.name) for p in bench.ports] == [
        ("out", "angle"),
        ("out", "button"),
        ("out", "level[0]"),
        ("out", "level[1]"),
        ("in", "voltage"),
    ]
    assert bench.parameters == ()
    assert bench.step == 500_000


def test_the_grid_is_the_greatest_common_divisor_of_the_periods() -> None:
    assert environment(PROGRAM, "Bench").step == 2 * MS
    assert environment(PROGRAM, "Hands").step == MS
    assert environment(PROGRAM, "Hands").on_miss == "count"


def test_states_and_outputs_of_the_members_keep_their_names() -> None:
    bench = system("Bench")
    names = {equation.name for equation in bench.equations}
    assert [state.name for state in bench.states][:2] == ["motor.theta", "motor.omega"]
    assert {"motor.speed", "finger.button", "tank[0].y"} <= names


def test_the_system_runs() -> None:
    bench = Law(system("Bench"), {})
    assert bench.constants["sample"] == 0.002
    for _ in range(100):
        signals = bench.evaluate(voltage=3.0)
        bench.advance(signals, 0.002)
    final = bench.evaluate(voltage=3.0)
    assert abs(final["motor.speed"] - 2 * (1 - 2.718281828459045 ** (-3 * 0.2))) < 1e-9
    assert final["level[0]"] > 0.19
    assert final["level[1]"] == 0.0
    assert final["button"] == 0


def test_parameters_may_be_set_from_outside() -> None:
    assert Law(system("Bench"), {}).constants["motor.gain"] == 2.0
    changed = Law(system("Bench", motor__gain=7.0, motor__friction__coefficient=9.0), {})
    assert changed.constants["motor.gain"] == 7.0
    assert changed.constants["motor.friction.coefficient"] == 9.0


def test_drivers_are_next_to_the_system() -> None:
    hands = environment(PROGRAM, "Hands")
    (stick,) = hands.drivers
    assert stick.arguments == (("port", "left"), ("scale", 2.0))
    assert stick.connections == (("x", "button"), ("levels[0]", "level[0]"), ("levels[1]", "level[1]"))
    assert hands.system is not None
    assert [p.name for p in hands.system.ports] == ["angle", "voltage"]


def test_an_environment_of_drivers_only_has_no_system() -> None:
    text = """
    process Lamp { out on_ : bool @ 10 ms  composition { mu (on_ ! true ; wait 10 ms) } }
    driver Led python "led.py:Led" { in light : bool }
    environment Board for Lamp { led : Led  on_ -> led.light }
    """
    board = environment(text)
    assert board.system is None
    assert board.drivers[0].connections == (("light", "on_"),)


def test_a_value_may_go_straight_back() -> None:
    text = """
    process Echo {
      in  x : double @ 10 ms
      out y : double @ 10 ms
      communication { var last : double = 0 }
      composition { mu (x ? last ; y ! last + 1) }
    }
    environment Wire for Echo { y -> x }
    """
    wire = environment(text).system
    assert wire is not None
    assert Law(wire, {}).evaluate(y=4.0)["x"] == 4.0


@pytest.mark.parametrize(
    "wrong",
    [
        "[3] - 3", "-[1]", "not 3", "sqrt()", "sqrt([3.0])", "min([1], 2)", "int([3])", "double([3])", "convert()",
        "if [3] < 3.0 then 5<rad/V/s^2> else 6<rad/V/s^2>", 'if "a" < 3 then 5<rad/V/s^2> else 6<rad/V/s^2>',
        'floor("x")', "Missing(a = 1).a",
    ],
)  # fmt: skip
@pytest.mark.parametrize("replaced", ["motor : Motor(gain = {})", "Motor(gain: double<rad/V/s^2> = {})"])
def test_values_of_wrong_types_are_reported_and_not_computed_with(replaced: str, wrong: str) -> None:
    pattern = re.escape(replaced).replace(r"\{\}", ".*?") + r"(?=\n| step)"
    text, times = re.subn(pattern, replaced.format(wrong), PROGRAM)
    assert times == 1
    errors = [
        found
        for found in pipeline.check(SourceFile(name="case.csp", text=text), read_source).report.diagnostics
        if found.severity == "error"
    ]
    assert errors
    assert all(wrong in text.splitlines()[found.span.line - 1] for found in errors)
