"""The environment Bench."""

from __future__ import annotations

from collections.abc import Mapping
from math import ceil

from ..runtime import Driver, Signal, finite, s, us

motor_resistance = 1.0  # cascade.csp:96
motor_constant = 0.05  # cascade.csp:97
motor_inductance = 1e-3  # cascade.csp:96
motor_friction = 1e-5  # cascade.csp:98
motor_inertia = 1e-4  # cascade.csp:97


class Bench:
    """The environment Bench.

    Source: cascade.csp:122
    """

    step = 100 * us
    on_miss = "timeout"

    def __init__(self) -> None:
        self.now = 0
        self.reference = Signal[float](0.0)
        self.speed = Signal[float](0.0)
        self.current = Signal[float](0.0)
        self.voltage = Signal[float](0.0)
        self.drivers: Mapping[str, Driver] = {
            "reference": self.reference,
            "speed": self.speed,
            "current": self.current,
            "voltage": self.voltage,
        }

    def start(self) -> None:
        """Go to time 0 and evaluate the outputs."""
        self.now = 0
        self.motor_i = 0.0
        self.motor_w = 0.0
        self._evaluate()

    def advance(self, now: int) -> None:
        """Integrate to `now` (in nanoseconds) with the inputs held, and evaluate the outputs."""
        time = self.now / s
        voltage = self.voltage.value
        motor_i = self.motor_i
        motor_w = self.motor_w
        motor_voltage = voltage  # cascade.csp:128
        steps = ceil((now - self.now) / (100 * us))
        h = (now - self.now) / s / steps
        half = h / 2
        sixth = h / 6
        for step in range(steps):
            t = time + step * h
            k1_motor_i, k1_motor_w = self._derivatives(motor_i, motor_w, motor_voltage, t)
            k2_motor_i, k2_motor_w = self._derivatives(
                motor_i + half * k1_motor_i, motor_w + half * k1_motor_w, motor_voltage, t + half
            )
            k3_motor_i, k3_motor_w = self._derivatives(
                motor_i + half * k2_motor_i, motor_w + half * k2_motor_w, motor_voltage, t + half
            )
            k4_motor_i, k4_motor_w = self._derivatives(
                motor_i + h * k3_motor_i, motor_w + h * k3_motor_w, motor_voltage, t + h
            )
            motor_i += sixth * (k1_motor_i + 2.0 * k2_motor_i + 2.0 * k3_motor_i + k4_motor_i)
            motor_w += sixth * (k1_motor_w + 2.0 * k2_motor_w + 2.0 * k3_motor_w + k4_motor_w)
        self.motor_i = finite(motor_i)  # cascade.csp:107
        self.motor_w = finite(motor_w)  # cascade.csp:108
        self.now = now
        self._evaluate()

    def _evaluate(self) -> None:
        time = self.now / s
        motor_current = self.motor_i  # cascade.csp:109
        motor_speed = self.motor_w  # cascade.csp:110
        trial_reference = 0.0 if time < 0.02 else 100.0  # cascade.csp:118
        self.reference.value = trial_reference  # cascade.csp:126
        self.current.value = motor_current  # cascade.csp:129
        self.speed.value = motor_speed  # cascade.csp:130

    def _derivatives(
        self,
        motor_i: float,
        motor_w: float,
        motor_voltage: float,
        time: float,
    ) -> tuple[float, float]:
        trial_load = 0.0 if time < 0.3 else 0.05  # cascade.csp:119
        motor_load = trial_load  # cascade.csp:127
        # cascade.csp:107
        motor_i_slope = (
            motor_voltage - motor_resistance * motor_i - motor_constant * motor_w
        ) / motor_inductance
        # cascade.csp:108
        motor_w_slope = (
            motor_constant * motor_i - motor_friction * motor_w - motor_load
        ) / motor_inertia
        return motor_i_slope, motor_w_slope
