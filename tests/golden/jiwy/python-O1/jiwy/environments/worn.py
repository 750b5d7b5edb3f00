"""The environment Worn."""

from __future__ import annotations

from collections.abc import Mapping
from math import ceil, cos, nan, sin

from ..runtime import Driver, Signal, finite, ms, quantize


class Worn:
    """A worn machine, its friction up by 30 %, switched on near its end stops, in the hand of an
    impatient operator.

    Source: jiwy.csp:183
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
        self.pan_angle = 1.4
        self.pan_speed = 0.0
        self.tilt_angle = -2.0
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
        pan_voltage = control_horizontal  # jiwy.csp:194
        tilt_voltage = control_vertical  # jiwy.csp:195
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
                - 0.0013 * pan_speed
                - 0.0 * (sin(pan_angle) if pan_angle - pan_angle == 0.0 else nan)
                + pan_stop_within
            )
            # plant.csp:42
            pan_friction_within = (
                (
                    -0.02028
                    if (x1 := pan_torque_within + 0.0010289327 * pan_speed / 0.002) < -0.02028
                    else 0.02028
                    if x1 > 0.02028
                    else x1
                )
                if pan_speed < 0.02 and pan_speed > -0.02
                else 0.0156
                if pan_speed > 0.0
                else -0.0156
            )
            # plant.csp:40
            tilt_torque_within = (
                0.04835642201834862 * (tilt_voltage - 0.12402 * tilt_speed)
                - 0.00065 * tilt_speed
                - 0.01 * (sin(tilt_angle) if tilt_angle - tilt_angle == 0.0 else nan)
                + tilt_stop_within
            )
            # plant.csp:42
            tilt_friction_within = (
                (
                    -0.013519999999999999
                    if (x1 := tilt_torque_within + 0.00032893269999999996 * tilt_speed / 0.002)
                    < -0.013519999999999999
                    else 0.013519999999999999
                    if x1 > 0.013519999999999999
                    else x1
                )
                if tilt_speed < 0.04 and tilt_speed > -0.04
                else 0.0104
                if tilt_speed > 0.0
                else -0.0104
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
                - 0.0013 * pan_speed_at
                - 0.0 * (sin(pan_angle_at) if pan_angle_at - pan_angle_at == 0.0 else nan)
                + pan_stop_within
            )
            # plant.csp:42
            pan_friction_within = (
                (
                    -0.02028
                    if (x1 := pan_torque_within + 0.0010289327 * pan_speed_at / 0.002) < -0.02028
                    else 0.02028
                    if x1 > 0.02028
                    else x1
                )
                if pan_speed_at < 0.02 and pan_speed_at > -0.02
                else 0.0156
                if pan_speed_at > 0.0
                else -0.0156
            )
            # plant.csp:40
            tilt_torque_within = (
                0.04835642201834862 * (tilt_voltage - 0.12402 * tilt_speed_at)
                - 0.00065 * tilt_speed_at
                - 0.01 * (sin(tilt_angle_at) if tilt_angle_at - tilt_angle_at == 0.0 else nan)
                + tilt_stop_within
            )
            # plant.csp:42
            tilt_friction_within = (
                (
                    -0.013519999999999999
                    if (x1 := tilt_torque_within + 0.00032893269999999996 * tilt_speed_at / 0.002)
                    < -0.013519999999999999
                    else 0.013519999999999999
                    if x1 > 0.013519999999999999
                    else x1
                )
                if tilt_speed_at < 0.04 and tilt_speed_at > -0.04
                else 0.0104
                if tilt_speed_at > 0.0
                else -0.0104
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
                - 0.0013 * pan_speed_at
                - 0.0 * (sin(pan_angle_at) if pan_angle_at - pan_angle_at == 0.0 else nan)
                + pan_stop_within
            )
            # plant.csp:42
            pan_friction_within = (
                (
                    -0.02028
                    if (x1 := pan_torque_within + 0.0010289327 * pan_speed_at / 0.002) < -0.02028
                    else 0.02028
                    if x1 > 0.02028
                    else x1
                )
                if pan_speed_at < 0.02 and pan_speed_at > -0.02
                else 0.0156
                if pan_speed_at > 0.0
                else -0.0156
            )
            # plant.csp:40
            tilt_torque_within = (
                0.04835642201834862 * (tilt_voltage - 0.12402 * tilt_speed_at)
                - 0.00065 * tilt_speed_at
                - 0.01 * (sin(tilt_angle_at) if tilt_angle_at - tilt_angle_at == 0.0 else nan)
                + tilt_stop_within
            )
            # plant.csp:42
            tilt_friction_within = (
                (
                    -0.013519999999999999
                    if (x1 := tilt_torque_within + 0.00032893269999999996 * tilt_speed_at / 0.002)
                    < -0.013519999999999999
                    else 0.013519999999999999
                    if x1 > 0.013519999999999999
                    else x1
                )
                if tilt_speed_at < 0.04 and tilt_speed_at > -0.04
                else 0.0104
                if tilt_speed_at > 0.0
                else -0.0104
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
                - 0.0013 * pan_speed_at
                - 0.0 * (sin(pan_angle_at) if pan_angle_at - pan_angle_at == 0.0 else nan)
                + pan_stop_within
            )
            # plant.csp:42
            pan_friction_within = (
                (
                    -0.02028
                    if (x1 := pan_torque_within + 0.0010289327 * pan_speed_at / 0.002) < -0.02028
                    else 0.02028
                    if x1 > 0.02028
                    else x1
                )
                if pan_speed_at < 0.02 and pan_speed_at > -0.02
                else 0.0156
                if pan_speed_at > 0.0
                else -0.0156
            )
            # plant.csp:40
            tilt_torque_within = (
                0.04835642201834862 * (tilt_voltage - 0.12402 * tilt_speed_at)
                - 0.00065 * tilt_speed_at
                - 0.01 * (sin(tilt_angle_at) if tilt_angle_at - tilt_angle_at == 0.0 else nan)
                + tilt_stop_within
            )
            # plant.csp:42
            tilt_friction_within = (
                (
                    -0.013519999999999999
                    if (x1 := tilt_torque_within + 0.00032893269999999996 * tilt_speed_at / 0.002)
                    < -0.013519999999999999
                    else 0.013519999999999999
                    if x1 > 0.013519999999999999
                    else x1
                )
                if tilt_speed_at < 0.04 and tilt_speed_at > -0.04
                else 0.0104
                if tilt_speed_at > 0.0
                else -0.0104
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
            if (x1_ := quantize(pan_angle - 1.4, 0.0002894303373369134)) - x1_ == 0.0
            else finite(x1_)
        )
        # plant.csp:49
        tilt_encoder = (
            x1_
            if (x1_ := quantize(tilt_angle - -2.0, 0.0002894303373369134)) - x1_ == 0.0
            else finite(x1_)
        )
        hand_phase = 2.5132741228718345 * time  # plant.csp:74
        hand_x = 0.5 * (sin(hand_phase) if hand_phase - hand_phase == 0.0 else nan)  # plant.csp:75
        hand_y = 0.5 * (cos(hand_phase) if hand_phase - hand_phase == 0.0 else nan)  # plant.csp:76
        hand_buttons = 2 if (time >= 2.0 and time < 2.2) or time >= 15.0 else 0  # plant.csp:77
        self.feedback_horizontal.value = pan_encoder  # jiwy.csp:196
        self.feedback_vertical.value = tilt_encoder  # jiwy.csp:197
        # jiwy.csp:198
        self.joystick_horizontal.value = hand_x if hand_x - hand_x == 0.0 else finite(hand_x)
        # jiwy.csp:199
        self.joystick_vertical.value = hand_y if hand_y - hand_y == 0.0 else finite(hand_y)
        self.joystick_buttons.value = hand_buttons  # jiwy.csp:200

    def _evaluate(self) -> None:
        time = self.now / 1_000_000_000
        # plant.csp:49
        pan_encoder = (
            x1_3
            if (x1_3 := quantize(self.pan_angle - 1.4, 0.0002894303373369134)) - x1_3 == 0.0
            else finite(x1_3)
        )
        # plant.csp:49
        tilt_encoder = (
            x1_3
            if (x1_3 := quantize(self.tilt_angle - -2.0, 0.0002894303373369134)) - x1_3 == 0.0
            else finite(x1_3)
        )
        hand_phase = 2.5132741228718345 * time  # plant.csp:74
        hand_x = 0.5 * (sin(hand_phase) if hand_phase - hand_phase == 0.0 else nan)  # plant.csp:75
        hand_y = 0.5 * (cos(hand_phase) if hand_phase - hand_phase == 0.0 else nan)  # plant.csp:76
        hand_buttons = 2 if (time >= 2.0 and time < 2.2) or time >= 15.0 else 0  # plant.csp:77
        self.feedback_horizontal.value = pan_encoder  # jiwy.csp:196
        self.feedback_vertical.value = tilt_encoder  # jiwy.csp:197
        # jiwy.csp:198
        self.joystick_horizontal.value = hand_x if hand_x - hand_x == 0.0 else finite(hand_x)
        # jiwy.csp:199
        self.joystick_vertical.value = hand_y if hand_y - hand_y == 0.0 else finite(hand_y)
        self.joystick_buttons.value = hand_buttons  # jiwy.csp:200

    def _divide(self, elapsed: int) -> None:
        """Divide the time between two instants into equal steps."""
        self._elapsed = elapsed
        self._steps = range(ceil(elapsed / 1_000_000))
        self._h = elapsed / 1_000_000_000 / len(self._steps)
        self._half = self._h / 2
        self._sixth = self._h / 6
