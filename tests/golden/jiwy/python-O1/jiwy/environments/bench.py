"""The environment Bench."""

from __future__ import annotations

from collections.abc import Mapping
from math import ceil, nan, sin

from ..runtime import Driver, Signal, finite, ms, quantize


class Bench:
    """Both joints stand somewhere between their end stops; the operator moves the stick, presses
    the button, lets go.

    Source: jiwy.csp:162
    """

    step = 1 * ms
    on_miss = "timeout"

    def __init__(self) -> None:
        self.now = 0
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
        self._elapsed = 0
        self.pan_angle = 0.3
        self.pan_speed = 0.0
        self.tilt_angle = -0.4
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
        elapsed = now - self.now
        if elapsed != self._elapsed:
            self._divide(elapsed)
        h = self._h
        half = self._half
        sixth = self._sixth
        for _ in self._steps:
            # plant.csp:35
            pan_stop_within = (
                (x1 if 0.0 < (x1 := 50.0 * (-1.62 - pan_angle) - 0.3 * pan_speed) else 0.0)
                if pan_angle < -1.62
                else (x2 if 0.0 > (x2 := 50.0 * (1.5 - pan_angle) - 0.3 * pan_speed) else 0.0)
                if pan_angle > 1.5
                else 0.0
            )
            # plant.csp:35
            tilt_stop_within = (
                (x1 if 0.0 < (x1 := 50.0 * (-2.05 - tilt_angle) - 0.15 * tilt_speed) else 0.0)
                if tilt_angle < -2.05
                else (x2 if 0.0 > (x2 := 50.0 * (1.85 - tilt_angle) - 0.15 * tilt_speed) else 0.0)
                if tilt_angle > 1.85
                else 0.0
            )
            # plant.csp:40
            pan_torque_within = (
                0.04835642201834862 * (pan_voltage - 0.12402 * pan_speed)
                - 0.001 * pan_speed
                - 0.0 * (sin(pan_angle) if pan_angle - pan_angle == 0.0 else nan)
                + pan_stop_within
            )
            # plant.csp:42
            pan_friction_within = (
                (
                    -0.015600000000000001
                    if (x1 := pan_torque_within + 0.0010289327 * pan_speed / 0.002)
                    < -0.015600000000000001
                    else 0.015600000000000001
                    if x1 > 0.015600000000000001
                    else x1
                )
                if pan_speed < 0.02 and pan_speed > -0.02
                else 0.012
                if pan_speed > 0.0
                else -0.012
            )
            # plant.csp:40
            tilt_torque_within = (
                0.04835642201834862 * (tilt_voltage - 0.12402 * tilt_speed)
                - 0.0005 * tilt_speed
                - 0.01 * (sin(tilt_angle) if tilt_angle - tilt_angle == 0.0 else nan)
                + tilt_stop_within
            )
            # plant.csp:42
            tilt_friction_within = (
                (
                    -0.010400000000000001
                    if (x1 := tilt_torque_within + 0.00032893269999999996 * tilt_speed / 0.002)
                    < -0.010400000000000001
                    else 0.010400000000000001
                    if x1 > 0.010400000000000001
                    else x1
                )
                if tilt_speed < 0.04 and tilt_speed > -0.04
                else 0.008
                if tilt_speed > 0.0
                else -0.008
            )
            k1_pan_angle = pan_speed
            k1_pan_speed = (pan_torque_within - pan_friction_within) / 0.0010289327  # plant.csp:48
            k1_tilt_angle = tilt_speed
            # plant.csp:48
            k1_tilt_speed = (tilt_torque_within - tilt_friction_within) / 0.00032893269999999996
            pan_angle_at = pan_angle + half * k1_pan_angle
            pan_speed_at = pan_speed + half * k1_pan_speed
            tilt_angle_at = tilt_angle + half * k1_tilt_angle
            tilt_speed_at = tilt_speed + half * k1_tilt_speed
            # plant.csp:35
            pan_stop_within = (
                (x1 if 0.0 < (x1 := 50.0 * (-1.62 - pan_angle_at) - 0.3 * pan_speed_at) else 0.0)
                if pan_angle_at < -1.62
                else (x2 if 0.0 > (x2 := 50.0 * (1.5 - pan_angle_at) - 0.3 * pan_speed_at) else 0.0)
                if pan_angle_at > 1.5
                else 0.0
            )
            # plant.csp:35
            tilt_stop_within = (
                (x1 if 0.0 < (x1 := 50.0 * (-2.05 - tilt_angle_at) - 0.15 * tilt_speed_at) else 0.0)
                if tilt_angle_at < -2.05
                else (
                    x2
                    if 0.0 > (x2 := 50.0 * (1.85 - tilt_angle_at) - 0.15 * tilt_speed_at)
                    else 0.0
                )
                if tilt_angle_at > 1.85
                else 0.0
            )
            # plant.csp:40
            pan_torque_within = (
                0.04835642201834862 * (pan_voltage - 0.12402 * pan_speed_at)
                - 0.001 * pan_speed_at
                - 0.0 * (sin(pan_angle_at) if pan_angle_at - pan_angle_at == 0.0 else nan)
                + pan_stop_within
            )
            # plant.csp:42
            pan_friction_within = (
                (
                    -0.015600000000000001
                    if (x1 := pan_torque_within + 0.0010289327 * pan_speed_at / 0.002)
                    < -0.015600000000000001
                    else 0.015600000000000001
                    if x1 > 0.015600000000000001
                    else x1
                )
                if pan_speed_at < 0.02 and pan_speed_at > -0.02
                else 0.012
                if pan_speed_at > 0.0
                else -0.012
            )
            # plant.csp:40
            tilt_torque_within = (
                0.04835642201834862 * (tilt_voltage - 0.12402 * tilt_speed_at)
                - 0.0005 * tilt_speed_at
                - 0.01 * (sin(tilt_angle_at) if tilt_angle_at - tilt_angle_at == 0.0 else nan)
                + tilt_stop_within
            )
            # plant.csp:42
            tilt_friction_within = (
                (
                    -0.010400000000000001
                    if (x1 := tilt_torque_within + 0.00032893269999999996 * tilt_speed_at / 0.002)
                    < -0.010400000000000001
                    else 0.010400000000000001
                    if x1 > 0.010400000000000001
                    else x1
                )
                if tilt_speed_at < 0.04 and tilt_speed_at > -0.04
                else 0.008
                if tilt_speed_at > 0.0
                else -0.008
            )
            k2_pan_angle = pan_speed_at
            k2_pan_speed = (pan_torque_within - pan_friction_within) / 0.0010289327  # plant.csp:48
            k2_tilt_angle = tilt_speed_at
            # plant.csp:48
            k2_tilt_speed = (tilt_torque_within - tilt_friction_within) / 0.00032893269999999996
            pan_angle_at = pan_angle + half * k2_pan_angle
            pan_speed_at = pan_speed + half * k2_pan_speed
            tilt_angle_at = tilt_angle + half * k2_tilt_angle
            tilt_speed_at = tilt_speed + half * k2_tilt_speed
            # plant.csp:35
            pan_stop_within = (
                (x1 if 0.0 < (x1 := 50.0 * (-1.62 - pan_angle_at) - 0.3 * pan_speed_at) else 0.0)
                if pan_angle_at < -1.62
                else (x2 if 0.0 > (x2 := 50.0 * (1.5 - pan_angle_at) - 0.3 * pan_speed_at) else 0.0)
                if pan_angle_at > 1.5
                else 0.0
            )
            # plant.csp:35
            tilt_stop_within = (
                (x1 if 0.0 < (x1 := 50.0 * (-2.05 - tilt_angle_at) - 0.15 * tilt_speed_at) else 0.0)
                if tilt_angle_at < -2.05
                else (
                    x2
                    if 0.0 > (x2 := 50.0 * (1.85 - tilt_angle_at) - 0.15 * tilt_speed_at)
                    else 0.0
                )
                if tilt_angle_at > 1.85
                else 0.0
            )
            # plant.csp:40
            pan_torque_within = (
                0.04835642201834862 * (pan_voltage - 0.12402 * pan_speed_at)
                - 0.001 * pan_speed_at
                - 0.0 * (sin(pan_angle_at) if pan_angle_at - pan_angle_at == 0.0 else nan)
                + pan_stop_within
            )
            # plant.csp:42
            pan_friction_within = (
                (
                    -0.015600000000000001
                    if (x1 := pan_torque_within + 0.0010289327 * pan_speed_at / 0.002)
                    < -0.015600000000000001
                    else 0.015600000000000001
                    if x1 > 0.015600000000000001
                    else x1
                )
                if pan_speed_at < 0.02 and pan_speed_at > -0.02
                else 0.012
                if pan_speed_at > 0.0
                else -0.012
            )
            # plant.csp:40
            tilt_torque_within = (
                0.04835642201834862 * (tilt_voltage - 0.12402 * tilt_speed_at)
                - 0.0005 * tilt_speed_at
                - 0.01 * (sin(tilt_angle_at) if tilt_angle_at - tilt_angle_at == 0.0 else nan)
                + tilt_stop_within
            )
            # plant.csp:42
            tilt_friction_within = (
                (
                    -0.010400000000000001
                    if (x1 := tilt_torque_within + 0.00032893269999999996 * tilt_speed_at / 0.002)
                    < -0.010400000000000001
                    else 0.010400000000000001
                    if x1 > 0.010400000000000001
                    else x1
                )
                if tilt_speed_at < 0.04 and tilt_speed_at > -0.04
                else 0.008
                if tilt_speed_at > 0.0
                else -0.008
            )
            k3_pan_angle = pan_speed_at
            k3_pan_speed = (pan_torque_within - pan_friction_within) / 0.0010289327  # plant.csp:48
            k3_tilt_angle = tilt_speed_at
            # plant.csp:48
            k3_tilt_speed = (tilt_torque_within - tilt_friction_within) / 0.00032893269999999996
            pan_angle_at = pan_angle + h * k3_pan_angle
            pan_speed_at = pan_speed + h * k3_pan_speed
            tilt_angle_at = tilt_angle + h * k3_tilt_angle
            tilt_speed_at = tilt_speed + h * k3_tilt_speed
            # plant.csp:35
            pan_stop_within = (
                (x1 if 0.0 < (x1 := 50.0 * (-1.62 - pan_angle_at) - 0.3 * pan_speed_at) else 0.0)
                if pan_angle_at < -1.62
                else (x2 if 0.0 > (x2 := 50.0 * (1.5 - pan_angle_at) - 0.3 * pan_speed_at) else 0.0)
                if pan_angle_at > 1.5
                else 0.0
            )
            # plant.csp:35
            tilt_stop_within = (
                (x1 if 0.0 < (x1 := 50.0 * (-2.05 - tilt_angle_at) - 0.15 * tilt_speed_at) else 0.0)
                if tilt_angle_at < -2.05
                else (
                    x2
                    if 0.0 > (x2 := 50.0 * (1.85 - tilt_angle_at) - 0.15 * tilt_speed_at)
                    else 0.0
                )
                if tilt_angle_at > 1.85
                else 0.0
            )
            # plant.csp:40
            pan_torque_within = (
                0.04835642201834862 * (pan_voltage - 0.12402 * pan_speed_at)
                - 0.001 * pan_speed_at
                - 0.0 * (sin(pan_angle_at) if pan_angle_at - pan_angle_at == 0.0 else nan)
                + pan_stop_within
            )
            # plant.csp:42
            pan_friction_within = (
                (
                    -0.015600000000000001
                    if (x1 := pan_torque_within + 0.0010289327 * pan_speed_at / 0.002)
                    < -0.015600000000000001
                    else 0.015600000000000001
                    if x1 > 0.015600000000000001
                    else x1
                )
                if pan_speed_at < 0.02 and pan_speed_at > -0.02
                else 0.012
                if pan_speed_at > 0.0
                else -0.012
            )
            # plant.csp:40
            tilt_torque_within = (
                0.04835642201834862 * (tilt_voltage - 0.12402 * tilt_speed_at)
                - 0.0005 * tilt_speed_at
                - 0.01 * (sin(tilt_angle_at) if tilt_angle_at - tilt_angle_at == 0.0 else nan)
                + tilt_stop_within
            )
            # plant.csp:42
            tilt_friction_within = (
                (
                    -0.010400000000000001
                    if (x1 := tilt_torque_within + 0.00032893269999999996 * tilt_speed_at / 0.002)
                    < -0.010400000000000001
                    else 0.010400000000000001
                    if x1 > 0.010400000000000001
                    else x1
                )
                if tilt_speed_at < 0.04 and tilt_speed_at > -0.04
                else 0.008
                if tilt_speed_at > 0.0
                else -0.008
            )
            k4_pan_angle = pan_speed_at
            k4_pan_speed = (pan_torque_within - pan_friction_within) / 0.0010289327  # plant.csp:48
            k4_tilt_angle = tilt_speed_at
            # plant.csp:48
            k4_tilt_speed = (tilt_torque_within - tilt_friction_within) / 0.00032893269999999996
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
        if pan_angle - pan_angle != 0.0:
            finite(pan_angle)  # plant.csp:47
        self.pan_angle = pan_angle
        if pan_speed - pan_speed != 0.0:
            finite(pan_speed)  # plant.csp:48
        self.pan_speed = pan_speed
        if tilt_angle - tilt_angle != 0.0:
            finite(tilt_angle)  # plant.csp:47
        self.tilt_angle = tilt_angle
        if tilt_speed - tilt_speed != 0.0:
            finite(tilt_speed)  # plant.csp:48
        self.tilt_speed = tilt_speed
        self.now = now
        time = now / 1_000_000_000
        # plant.csp:49
        pan_encoder = (
            x1_
            if (x1_ := quantize(pan_angle - 0.3, 0.0002894303373369134)) - x1_ == 0.0
            else finite(x1_)
        )
        # plant.csp:49
        tilt_encoder = (
            x1_
            if (x1_ := quantize(tilt_angle - -0.4, 0.0002894303373369134)) - x1_ == 0.0
            else finite(x1_)
        )
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

    def _evaluate(self) -> None:
        time = self.now / 1_000_000_000
        # plant.csp:49
        pan_encoder = (
            x1_3
            if (x1_3 := quantize(self.pan_angle - 0.3, 0.0002894303373369134)) - x1_3 == 0.0
            else finite(x1_3)
        )
        # plant.csp:49
        tilt_encoder = (
            x1_3
            if (x1_3 := quantize(self.tilt_angle - -0.4, 0.0002894303373369134)) - x1_3 == 0.0
            else finite(x1_3)
        )
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

    def _divide(self, elapsed: int) -> None:
        """Divide the time between two instants into equal steps."""
        self._elapsed = elapsed
        self._steps = range(ceil(elapsed / 1_000_000))
        self._h = elapsed / 1_000_000_000 / len(self._steps)
        self._half = self._h / 2
        self._sixth = self._h / 6
