"""The environment Bench."""

from __future__ import annotations

from collections.abc import Mapping
from math import ceil, pi

from ..constants import counts, drive, induction, ratio, rotorInertia, stiffness
from ..parameters import Parameters
from ..runtime import Driver, Signal, finite, limit, ms, power, quantize, s, sin

pan_start = 0.3  # plant.csp:26
pan_left = -1.62  # plant.csp:26
pan_damper = 0.3  # plant.csp:26
pan_right = 1.5  # plant.csp:26
pan_inertia = 1e-3  # plant.csp:25
pan_mass = pan_inertia + power(ratio, 2.0) * rotorInertia  # plant.csp:39
pan_viscous = 1e-3  # plant.csp:25
pan_gravity = 0.0  # plant.csp:25
pan_coulomb = 0.012  # plant.csp:25
pan_stiction = 1.3 * pan_coulomb  # plant.csp:41
pan_creep = 0.02  # plant.csp:27
pan_settling = 0.002  # plant.csp:27
tilt_start = -0.4  # plant.csp:26
tilt_left = -2.05  # plant.csp:26
tilt_damper = 0.15  # plant.csp:26
tilt_right = 1.85  # plant.csp:26
tilt_inertia = 3e-4  # plant.csp:25
tilt_mass = tilt_inertia + power(ratio, 2.0) * rotorInertia  # plant.csp:39
tilt_viscous = 5e-4  # plant.csp:25
tilt_gravity = 0.01  # plant.csp:25
tilt_coulomb = 0.008  # plant.csp:25
tilt_stiction = 1.3 * tilt_coulomb  # plant.csp:41
tilt_creep = 0.04  # plant.csp:27
tilt_settling = 0.002  # plant.csp:27


class Bench:
    """Both joints stand somewhere between their end stops; the operator moves the stick, presses
    the button, lets go.

    Source: jiwy.csp:162
    """

    step = 1 * ms
    on_miss = "timeout"

    def __init__(self, parameters: Parameters | None = None) -> None:
        self.now = 0
        self.parameters = parameters or Parameters()
        self.joystick_horizontal = Signal[float](0.0)
        self.joystick_vertical = Signal[float](0.0)
        self.joystick_buttons = Signal[int](0)
        self.feedback_horizontal = Signal[float](0.0)
        self.feedback_vertical = Signal[float](0.0)
        self.control_horizontal = Signal[float](0.0)
        self.control_vertical = Signal[float](0.0)
        self.drivers: Mapping[str, Driver] = {
            "joystick_horizontal": self.joystick_horizontal,
            "joystick_vertical": self.joystick_vertical,
            "joystick_buttons": self.joystick_buttons,
            "feedback_horizontal": self.feedback_horizontal,
            "feedback_vertical": self.feedback_vertical,
            "control_horizontal": self.control_horizontal,
            "control_vertical": self.control_vertical,
        }

    def start(self) -> None:
        """Go to time 0 and evaluate the outputs."""
        self.now = 0
        self.pan_angle = pan_start
        self.pan_speed = 0.0
        self.tilt_angle = tilt_start
        self.tilt_speed = 0.0
        self._evaluate()

    def advance(self, now: int) -> None:
        """Integrate to `now` (in nanoseconds) with the inputs held, and evaluate the outputs."""
        control_horizontal = self.control_horizontal.value
        control_vertical = self.control_vertical.value
        pan_angle = self.pan_angle
        pan_speed = self.pan_speed
        tilt_angle = self.tilt_angle
        tilt_speed = self.tilt_speed
        pan_voltage = control_horizontal  # jiwy.csp:173
        tilt_voltage = control_vertical  # jiwy.csp:174
        steps = ceil((now - self.now) / (1 * ms))
        h = (now - self.now) / s / steps
        half = h / 2
        sixth = h / 6
        for _ in range(steps):
            k1_pan_angle, k1_pan_speed, k1_tilt_angle, k1_tilt_speed = self._derivatives(
                pan_angle, pan_speed, tilt_angle, tilt_speed, pan_voltage, tilt_voltage
            )
            k2_pan_angle, k2_pan_speed, k2_tilt_angle, k2_tilt_speed = self._derivatives(
                pan_angle + half * k1_pan_angle,
                pan_speed + half * k1_pan_speed,
                tilt_angle + half * k1_tilt_angle,
                tilt_speed + half * k1_tilt_speed,
                pan_voltage,
                tilt_voltage,
            )
            k3_pan_angle, k3_pan_speed, k3_tilt_angle, k3_tilt_speed = self._derivatives(
                pan_angle + half * k2_pan_angle,
                pan_speed + half * k2_pan_speed,
                tilt_angle + half * k2_tilt_angle,
                tilt_speed + half * k2_tilt_speed,
                pan_voltage,
                tilt_voltage,
            )
            k4_pan_angle, k4_pan_speed, k4_tilt_angle, k4_tilt_speed = self._derivatives(
                pan_angle + h * k3_pan_angle,
                pan_speed + h * k3_pan_speed,
                tilt_angle + h * k3_tilt_angle,
                tilt_speed + h * k3_tilt_speed,
                pan_voltage,
                tilt_voltage,
            )
            pan_angle += sixth * (
                k1_pan_angle + 2.0 * k2_pan_angle + 2.0 * k3_pan_angle + k4_pan_angle
            )
            pan_speed += sixth * (
                k1_pan_speed + 2.0 * k2_pan_speed + 2.0 * k3_pan_speed + k4_pan_speed
            )
            tilt_angle += sixth * (
                k1_tilt_angle + 2.0 * k2_tilt_angle + 2.0 * k3_tilt_angle + k4_tilt_angle
            )
            tilt_speed += sixth * (
                k1_tilt_speed + 2.0 * k2_tilt_speed + 2.0 * k3_tilt_speed + k4_tilt_speed
            )
        self.pan_angle = finite(pan_angle)  # plant.csp:47
        self.pan_speed = finite(pan_speed)  # plant.csp:48
        self.tilt_angle = finite(tilt_angle)  # plant.csp:47
        self.tilt_speed = finite(tilt_speed)  # plant.csp:48
        self.now = now
        self._evaluate()

    def _evaluate(self) -> None:
        time = self.now / s
        # plant.csp:49
        pan_encoder = finite(quantize(self.pan_angle - pan_start, 2.0 * pi / counts))
        # plant.csp:49
        tilt_encoder = finite(quantize(self.tilt_angle - tilt_start, 2.0 * pi / counts))
        # plant.csp:57
        hand_stick = (
            0.0
            if time < 7.5 or time >= 12.5
            else 0.4
            if time < 8.5
            else 0.0
            if time < 9.5
            else -0.4
            if time < 10.5
            else 0.0
            if time < 11.5
            else 0.24
        )
        hand_x = hand_stick  # plant.csp:64
        hand_y = -hand_stick  # plant.csp:65
        hand_buttons = 2 if time >= 12.5 and time < 12.7 else 0  # plant.csp:66
        self.feedback_horizontal.value = pan_encoder  # jiwy.csp:175
        self.feedback_vertical.value = tilt_encoder  # jiwy.csp:176
        self.joystick_horizontal.value = hand_x  # jiwy.csp:177
        self.joystick_vertical.value = hand_y  # jiwy.csp:178
        self.joystick_buttons.value = hand_buttons  # jiwy.csp:179

    def _derivatives(
        self,
        pan_angle: float,
        pan_speed: float,
        tilt_angle: float,
        tilt_speed: float,
        pan_voltage: float,
        tilt_voltage: float,
    ) -> tuple[float, float, float, float]:
        # plant.csp:35
        pan_stop = (
            max(0.0, stiffness * (pan_left - pan_angle) - pan_damper * pan_speed)
            if pan_angle < pan_left
            else min(0.0, stiffness * (pan_right - pan_angle) - pan_damper * pan_speed)
            if pan_angle > pan_right
            else 0.0
        )
        # plant.csp:35
        tilt_stop = (
            max(0.0, stiffness * (tilt_left - tilt_angle) - tilt_damper * tilt_speed)
            if tilt_angle < tilt_left
            else min(0.0, stiffness * (tilt_right - tilt_angle) - tilt_damper * tilt_speed)
            if tilt_angle > tilt_right
            else 0.0
        )
        # plant.csp:40
        pan_torque = (
            drive * (pan_voltage - induction * pan_speed)
            - pan_viscous * pan_speed
            - pan_gravity * sin(pan_angle)
            + pan_stop
        )
        # plant.csp:42
        pan_friction = (
            limit(pan_torque + pan_mass * pan_speed / pan_settling, -pan_stiction, pan_stiction)
            if abs(pan_speed) < pan_creep
            else pan_coulomb
            if pan_speed > 0.0
            else -pan_coulomb
        )
        # plant.csp:40
        tilt_torque = (
            drive * (tilt_voltage - induction * tilt_speed)
            - tilt_viscous * tilt_speed
            - tilt_gravity * sin(tilt_angle)
            + tilt_stop
        )
        # plant.csp:42
        tilt_friction = (
            limit(
                tilt_torque + tilt_mass * tilt_speed / tilt_settling, -tilt_stiction, tilt_stiction
            )
            if abs(tilt_speed) < tilt_creep
            else tilt_coulomb
            if tilt_speed > 0.0
            else -tilt_coulomb
        )
        pan_speed_slope = (pan_torque - pan_friction) / pan_mass  # plant.csp:48
        tilt_speed_slope = (tilt_torque - tilt_friction) / tilt_mass  # plant.csp:48
        return pan_speed, pan_speed_slope, tilt_speed, tilt_speed_slope
