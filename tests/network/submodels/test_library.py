"""Every block of ``std.control`` against python-control, a closed form or a property that defines it."""

from __future__ import annotations

import math
from typing import Any

import control
import numpy
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cspdiag.base.files.resources import library_source
from cspdiag.semantics.equations.laws import Law
from cspdiag.syntax import ast
from tests.network.submodels.compiled import MS, instance, program

LIBRARY = "import std.control\n"
T = 0.001
WAVE = [math.sin(0.05 * k) + (0.5 if k > 40 else 0.0) for k in range(200)]


def make(name: str, sample: int = MS, **arguments: Any) -> Law:
    return instance(LIBRARY, name, sample, environment=True, **arguments)


def outputs(name: str, port: str, signal: list[Any], output: str, **arguments: Any) -> list[Any]:
    block = make(name, **arguments)
    return [block.sample(**{port: value})[output] for value in signal]


def discrete(numerator: list[float], denominator: list[float], signal: list[float]) -> Any:
    """Response of the Tustin discretization."""
    sampled = control.sample_system(control.tf(numerator, denominator), T, "tustin")
    return control.forced_response(sampled, U=signal).outputs


def test_every_block_has_a_documentation_comment() -> None:
    definitions = program(LIBRARY).definitions.values()
    assert [d.name.text for d in definitions if isinstance(d, ast.SubmodelDefinition) and not d.doc] == []


def test_every_block_is_tested_here() -> None:
    with open(__file__, encoding="utf-8") as file:
        text = file.read()
    names = [d.name.text for d in program(LIBRARY).definitions.values() if isinstance(d, ast.SubmodelDefinition)]
    assert [name for name in names if f'"{name}"' not in text] == []


def test_the_library_is_found_under_its_name() -> None:
    assert library_source("std.control")


def test_proportional_controller_limits() -> None:
    found = outputs("PController", "error", [0.1, 1.0, -1.0], "output", kp=2.0)
    assert found == [0.2, 1.0, -1.0]


def test_proportional_integral_controller_without_limits() -> None:
    found = outputs("PIController", "error", WAVE, "output", kp=2.0, tauI=50 * MS, lowest=-1e9, highest=1e9)
    area = numpy.concatenate([[0.0], numpy.cumsum(WAVE)[:-1]]) * T
    assert found == pytest.approx([2 * e + 2 / 0.05 * a for e, a in zip(WAVE, area, strict=True)])


@pytest.mark.parametrize(
    ("name", "port", "arguments"),
    [
        ("PIController", "error", {"kp": 2.0, "tauI": 50 * MS}),
        ("SeriesPID", "error", {"kp": 2.0, "tauD": 10 * MS, "beta": 0.1, "tauI": 50 * MS}),
        ("PIDController", "setpoint", {"kp": 2.0, "tauI": 50 * MS, "tauD": 10 * MS}),
    ],
)
def test_integrators_do_not_wind_up(name: str, port: str, arguments: dict[str, Any]) -> None:
    block = make(name, **arguments)
    rest = {"measurement": 0.0} if port == "setpoint" else {}
    for _ in range(5000):
        block.sample(**{port: 1.0, **rest})
    # Without anti-windup, the integral of 5 s would take 5 s to decay.
    found = [block.sample(**{port: -1.0, **rest})["output"] for _ in range(100)]
    assert found[-1] < 0


def test_proportional_derivative_controller_without_limits() -> None:
    kp, tau, n = 2.0, 0.02, 10.0
    found = outputs("PDController", "error", WAVE, "output", kp=kp, tauD=20 * MS, n=n, lowest=-1e9, highest=1e9)
    # kp (1 + s tau / (1 + s tau / n)) by backward differences: s = (z - 1) / (T z).
    z = control.tf([1, 0], [1], T)
    s = (z - 1) / (T * z)
    expected = control.forced_response(kp * (1 + s * tau / (1 + s * tau / n)), U=WAVE).outputs
    assert found == pytest.approx(expected)


def test_pid_controller_without_limits() -> None:
    kp, ti, td, n = 2.0, 0.05, 0.02, 10.0
    block = make("PIDController", kp=kp, tauI=50 * MS, tauD=20 * MS, n=n, lowest=-1e9, highest=1e9)
    found = [block.sample(setpoint=0.0, measurement=-e)["output"] for e in [0.0, *WAVE[1:]]]
    z = control.tf([1, 0], [1], T)
    rate = (z - 1) / (T * z) * td
    law = kp * (1 + T / (ti * (z - 1)) + rate / (1 + rate / n))
    expected = control.forced_response(law, U=[0.0, *WAVE[1:]]).outputs
    assert found == pytest.approx(expected)


def test_pid_controller_starts_without_a_kick() -> None:
    block = make("PIDController", kp=1.0, tauI=1000 * MS, tauD=100 * MS, lowest=-1e9, highest=1e9)
    assert block.sample(setpoint=5.0, measurement=5.0)["output"] == 0


def test_series_pid_is_the_published_difference_equation() -> None:
    kp, td, beta, ti = 1.6, 0.05, 0.17, 9.0
    found = outputs(
        "SeriesPID", "error", WAVE, "output", kp=kp, tauD=50 * MS, beta=beta, tauI=9000 * MS, lowest=-1e9, highest=1e9
    )
    e1 = ud = ui = 0.0
    expected = []
    for e in WAVE:
        ud = 1 / (T + td * beta) * (td * beta * ud + td * kp * (e - e1) + T * kp * e)
        ui = ui + T * ud / ti
        e1 = e
        expected.append(ui + ud)
    assert found == pytest.approx(expected)


W = 2 * math.pi * 20


@pytest.mark.parametrize(
    ("name", "arguments", "numerator", "denominator"),
    [
        ("LowPass", {"tau": 20 * MS}, [1], [0.02, 1]),
        ("LowPass2", {"frequency": 20.0}, [W**2], [1, math.sqrt(2) * W, W**2]),
        ("HighPass", {"tau": 20 * MS}, [0.02, 0], [0.02, 1]),
        ("LeadLag", {"lead": 30 * MS, "follow": 5 * MS}, [0.03, 1], [0.005, 1]),
        ("Notch", {"frequency": 20.0}, [1, 0.1 * W, W**2], [1, W, W**2]),
    ],
)
def test_filters_are_their_transfer_functions(
    name: str, arguments: dict[str, Any], numerator: list[float], denominator: list[float]
) -> None:
    found = outputs(name, "x", WAVE, "y", **arguments)
    assert found == pytest.approx(discrete(numerator, denominator, WAVE), abs=1e-9)


def test_saturation_quantizer_and_dead_zone() -> None:
    assert outputs("Saturation", "x", [-3.0, 0.5, 3.0], "y") == [-1.0, 0.5, 1.0]
    assert outputs("Quantizer", "x", [0.24, 0.26, -0.26, 0.25], "y", step=0.5) == [0.0, 0.5, -0.5, 0.5]
    assert outputs("DeadZone", "x", [-3.0, 0.5, 3.0], "y", width=1.0) == [-2.0, 0.0, 2.0]


def test_relay_has_hysteresis() -> None:
    found = outputs("Relay", "x", [0.0, 0.6, 1.1, 0.6, 0.4, 0.6], "active", lower=0.5, upper=1.0)
    assert found == [False, False, True, True, False, False]


@given(st.lists(st.floats(-10, 10), min_size=1, max_size=30))
def test_rate_limiter_never_moves_faster_and_follows_what_is_slower(signal: list[float]) -> None:
    found = outputs("RateLimiter", "x", signal, "y", rising=2000.0, falling=1000.0)
    for before, after, unlimited in zip([0.0, *found[:-1]], found, signal, strict=True):
        assert -1 - 1e-9 <= after - before <= 2 + 1e-9
        if -1 <= unlimited - before <= 2:
            assert after == pytest.approx(unlimited, abs=1e-12)


def test_ramp_goes_to_the_target_at_constant_speed() -> None:
    found = outputs("RampProfile", "target", [0.01] * 15, "value", speed=1.0)
    assert found == pytest.approx([min(0.001 * (k + 1), 0.01) for k in range(15)])


@settings(max_examples=15, deadline=None)
@given(st.floats(-3, 3), st.floats(0.5, 5), st.floats(2, 50))
def test_trapezoid_arrives_without_overshoot_and_keeps_its_limits(
    target: float, speed: float, acceleration: float
) -> None:
    period = 5 * T
    block = make("TrapezoidProfile", 5 * MS, speed=speed, acceleration=acceleration)
    values, rates = [0.0], [0.0]
    duration = abs(target) / speed + 2 * speed / acceleration + 0.5
    for _ in range(int(duration / period)):
        signals = block.sample(target=target)
        values.append(signals["value"])
        rates.append(signals["rate"])
    assert values[-1] == pytest.approx(target, abs=1e-9)
    assert max(abs(v) for v in values) <= abs(target) + 1e-9
    assert max(abs(r) for r in rates) <= speed + 1e-9
    changes = numpy.abs(numpy.diff(rates)) / period
    assert changes.max() <= acceleration * (1 + 1e-6) + 1e-6


def test_encoder_counts_and_back() -> None:
    assert outputs("Encoder", "angle", [0.0, 1.0, -1e-9, 3.15], "count", countsPerRevolution=1000.0) == [
        0, 159, -1, 501,
    ]  # fmt: skip
    assert outputs("Encoder", "angle", [1.0], "count", countsPerRevolution=1000.0, origin=1.0) == [0]
    assert outputs("EncoderAngle", "count", [250], "angle", countsPerRevolution=1000.0) == [pytest.approx(math.pi / 2)]


def test_speedometer_settles_at_the_slope() -> None:
    found = outputs("Speedometer", "angle", [5.0 + 3.0 * T * k for k in range(200)], "speed", tau=10 * MS)
    assert found[0] == 0
    assert found[-1] == pytest.approx(3.0, rel=1e-6)


def test_dc_motor_is_its_linear_model() -> None:
    r, inductance, k, j, b = 2.18, 0.24e-3, 0.0234, 1e-5, 1e-6
    block = make("DCMotor", resistance=r, inductance=inductance, torqueConstant=k, inertia=j, viscous=b)
    found = [block.sample(voltage=12.0, load=0.01)["speed"] for _ in range(100)]
    system = control.ss(
        [[-r / inductance, -k / inductance], [k / j, -b / j]], [[1 / inductance, 0], [0, -1 / j]], [[0, 1]], [[0, 0]]
    )
    expected = control.forced_response(
        control.sample_system(system, T, "zoh"), U=numpy.tile([[12.0], [0.01]], 100)
    ).outputs
    assert found == pytest.approx(expected.flatten(), rel=1e-4, abs=1e-3)


def test_simple_dc_motor_is_of_first_order() -> None:
    r, k, j = 2.18, 0.0234, 1e-5
    block = make("DCMotorSimple", resistance=r, torqueConstant=k, inertia=j)
    found = [block.sample(voltage=12.0, load=0.0)["speed"] for _ in range(100)]
    tau = r * j / k**2
    expected = [12 / k * (1 - math.exp(-T * n / tau)) for n in range(100)]
    assert found == pytest.approx(expected, rel=1e-6, abs=1e-6)


def test_dry_friction_holds_below_stiction_and_is_coulomb_in_motion() -> None:
    block = make("DryFriction", coulomb=0.01, stiction=0.013)
    at_rest = block.sample(torque=0.012, momentum=0.0, speed=0.0)["friction"]
    assert at_rest == 0.012
    assert block.sample(torque=0.02, momentum=0.0, speed=0.0)["friction"] == 0.013
    assert block.sample(torque=0.02, momentum=1e-4, speed=-1.0)["friction"] == -0.01


def test_end_stops_push_but_do_not_pull() -> None:
    block = make("EndStops", left=-1.0, right=1.0, stiffness=50.0, damper=0.3)

    def torque(angle: float, speed: float) -> float:
        return block.sample(angle=angle, speed=speed)["torque"]

    assert torque(0.0, 5.0) == 0
    assert torque(1.1, 0.0) == pytest.approx(-5.0)
    assert torque(1.01, -100.0) == 0
    assert torque(-1.1, 0.0) == pytest.approx(5.0)


JOINT = {
    "resistance": 2.18, "torqueConstant": 0.0234, "rotor": 1.03e-6, "ratio": 5.3, "efficiency": 0.85, "inertia": 3e-4,
    "viscous": 5e-4, "coulomb": 0.008, "stiction": 0.0104, "gravity": 0.01, "left": -2.05, "right": 1.85, "start": -0.4,
}  # fmt: skip


def test_joint_at_rest_does_not_creep() -> None:
    joint = make("MotorJoint", **JOINT)
    for _ in range(2000):
        joint.sample(voltage=0.0, load=0.0)
    assert joint.states["theta"] == pytest.approx(-0.4, abs=1e-9)


@pytest.mark.parametrize("sample", [MS // 2, MS])
def test_joint_comes_to_rest_at_its_end_stop(sample: int) -> None:
    joint = make("MotorJoint", sample, **JOINT)
    for _ in range(3 * 10**9 // sample):
        signals = joint.sample(voltage=2.0, load=0.0)
    torque = 0.85 * 5.3 * 0.0234 * 2.0 / 2.18 - 0.01 * math.sin(signals["angle"])
    assert abs(signals["speed"]) < 1e-6
    assert abs(50 * (signals["angle"] - 1.85) - torque) <= 0.0104 + 1e-6


def test_joint_loses_the_energy_that_friction_takes() -> None:
    free = {**JOINT, "gravity": 0.0, "viscous": 0.0, "torqueConstant": 1e-12, "start": 0.0}
    joint = make("MotorJoint", **free)
    joint.states["omega"] = 3.0
    mass = 3e-4 + 5.3**2 * 1.03e-6
    for _ in range(1000):
        signals = joint.sample(voltage=0.0, load=0.0)
    assert signals["angle"] == pytest.approx(mass * 3.0**2 / 2 / 0.008, rel=0.01)


def over_time(name: str, output: str, instants: list[float], **arguments: Any) -> list[Any]:
    block = make(name, **arguments)
    found = []
    for instant in instants:
        block.time = instant
        found.append(block.evaluate()[output])
    return found


def test_sources_over_time() -> None:
    assert over_time("StepSource", "y", [0.0, 0.999, 1.0], at=1000 * MS) == [0.0, 0.0, 1.0]
    assert over_time("RampSource", "y", [0.0, 1.0, 1.5], slope=2.0, at=1000 * MS) == [0.0, 0.0, 1.0]
    assert over_time("SineSource", "y", [0.0, 0.25], frequency=1.0, amplitude=2.0, offset=1.0) == [
        1.0,
        pytest.approx(3.0),
    ]
    assert over_time("PulseSource", "y", [0.0, 1.0, 2.0], begin=1000 * MS, finish=2000 * MS) == [0.0, 1.0, 0.0]
    assert over_time("PulseTrain", "y", [0.0, 0.3, 1.1, 1.3], period=1000 * MS, width=200 * MS) == [1.0, 0.0, 1.0, 0.0]
    assert over_time("ButtonSource", "y", [0.0, 1.0, 2.0], begin=1000 * MS, finish=2000 * MS, value=2) == [0, 2, 0]


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("StairsSource", lambda t: 5.0 if t < 0.002 else 7.0 if t < 0.004 else -1.0),
        ("PolylineSource", lambda t: float(numpy.interp(t, [0.001, 0.002, 0.004], [5.0, 7.0, -1.0]))),
    ],
)
def test_tables(name: str, expected: Any) -> None:
    table = make(name, n=3, times=(0.001, 0.002, 0.004), values=(5.0, 7.0, -1.0))
    for k in range(8):
        table.time = k * T
        assert table.sample()["y"] == pytest.approx(expected(k * T))
