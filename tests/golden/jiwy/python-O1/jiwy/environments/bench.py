"""The environment Bench."""

from __future__ import annotations

from collections.abc import Generator, Mapping
from math import ceil, isfinite, modf, nan, sin

from ..parameters import Parameters
from ..runtime import Driver, Signal, finite, ms


class Bench:
    """Both joints stand somewhere between their end stops; the operator moves the stick, presses
    the button, lets go.

    Source: jiwy.csp:162
    """

    step = 1 * ms
    on_miss = "timeout"

    def __init__(self, parameters: Parameters | None = None) -> None:
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
        self._run = self._running()
        next(self._run)

    def advance(self, now: int) -> None:
        """Integrate to `now` (in nanoseconds) with the inputs held, and evaluate the outputs."""
        self._run.send(now)

    def _running(self) -> Generator[None, int, None]:
        """Evaluate the outputs, wait for the next instant, integrate to it, and again."""
        joystick_horizontal_signal = self.joystick_horizontal
        joystick_vertical_signal = self.joystick_vertical
        joystick_buttons_signal = self.joystick_buttons
        feedback_horizontal_signal = self.feedback_horizontal
        feedback_vertical_signal = self.feedback_vertical
        control_horizontal_signal = self.control_horizontal
        control_vertical_signal = self.control_vertical
        pan_angle = 0.3
        pan_speed = 0.0
        tilt_angle = -0.4
        tilt_speed = 0.0
        now = 0
        elapsed = 0
        while True:
            time = now / 1_000_000_000
            x1, x2 = modf((pan_angle - 0.3) / 0.0002894303373369134)  # plant.csp:49
            pan_encoder = (
                x2 + 1.0 if x1 >= 0.5 else x2 - 1.0 if x1 <= -0.5 else x2
            ) * 0.0002894303373369134
            if pan_encoder - pan_encoder != 0.0:
                finite(pan_encoder)  # plant.csp:49
            x1, x2 = modf((tilt_angle - -0.4) / 0.0002894303373369134)  # plant.csp:49
            tilt_encoder = (
                x2 + 1.0 if x1 >= 0.5 else x2 - 1.0 if x1 <= -0.5 else x2
            ) * 0.0002894303373369134
            if tilt_encoder - tilt_encoder != 0.0:
                finite(tilt_encoder)  # plant.csp:49
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
            feedback_horizontal_signal.value = pan_encoder  # jiwy.csp:175
            feedback_vertical_signal.value = tilt_encoder  # jiwy.csp:176
            joystick_horizontal_signal.value = hand_x  # jiwy.csp:177
            joystick_vertical_signal.value = hand_y  # jiwy.csp:178
            joystick_buttons_signal.value = hand_buttons  # jiwy.csp:179
            before = now
            now = yield
            control_horizontal = control_horizontal_signal.value
            control_vertical = control_vertical_signal.value
            pan_voltage = control_horizontal  # jiwy.csp:173
            tilt_voltage = control_vertical  # jiwy.csp:174
            if now - before != elapsed:
                elapsed = now - before
                steps = range(ceil(elapsed / 1_000_000))
                h = elapsed / 1_000_000_000 / len(steps)
                half = h / 2
                sixth = h / 6
            for _ in steps:
                # plant.csp:35
                pan_stop_within = (
                    (x1_ if 0.0 < (x1_ := 50.0 * (-1.62 - pan_angle) - 0.3 * pan_speed) else 0.0)
                    if pan_angle < -1.62
                    else (x2_ if 0.0 > (x2_ := 50.0 * (1.5 - pan_angle) - 0.3 * pan_speed) else 0.0)
                    if pan_angle > 1.5
                    else 0.0
                )
                # plant.csp:35
                tilt_stop_within = (
                    (x1_ if 0.0 < (x1_ := 50.0 * (-2.05 - tilt_angle) - 0.15 * tilt_speed) else 0.0)
                    if tilt_angle < -2.05
                    else (
                        x2_
                        if 0.0 > (x2_ := 50.0 * (1.85 - tilt_angle) - 0.15 * tilt_speed)
                        else 0.0
                    )
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
                        if (x1_ := pan_torque_within + 0.0010289327 * pan_speed / 0.002)
                        < -0.015600000000000001
                        else 0.015600000000000001
                        if x1_ > 0.015600000000000001
                        else x1_
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
                        if (x1_ := tilt_torque_within + 0.00032893269999999996 * tilt_speed / 0.002)
                        < -0.010400000000000001
                        else 0.010400000000000001
                        if x1_ > 0.010400000000000001
                        else x1_
                    )
                    if tilt_speed < 0.04 and tilt_speed > -0.04
                    else 0.008
                    if tilt_speed > 0.0
                    else -0.008
                )
                k1_pan_angle = pan_speed
                # plant.csp:48
                k1_pan_speed = (pan_torque_within - pan_friction_within) / 0.0010289327
                k1_tilt_angle = tilt_speed
                # plant.csp:48
                k1_tilt_speed = (tilt_torque_within - tilt_friction_within) / 0.00032893269999999996
                pan_angle_at = pan_angle + half * k1_pan_angle
                pan_speed_at = pan_speed + half * k1_pan_speed
                tilt_angle_at = tilt_angle + half * k1_tilt_angle
                tilt_speed_at = tilt_speed + half * k1_tilt_speed
                # plant.csp:35
                pan_stop_within = (
                    (
                        x1_
                        if 0.0 < (x1_ := 50.0 * (-1.62 - pan_angle_at) - 0.3 * pan_speed_at)
                        else 0.0
                    )
                    if pan_angle_at < -1.62
                    else (
                        x2_
                        if 0.0 > (x2_ := 50.0 * (1.5 - pan_angle_at) - 0.3 * pan_speed_at)
                        else 0.0
                    )
                    if pan_angle_at > 1.5
                    else 0.0
                )
                # plant.csp:35
                tilt_stop_within = (
                    (
                        x1_
                        if 0.0 < (x1_ := 50.0 * (-2.05 - tilt_angle_at) - 0.15 * tilt_speed_at)
                        else 0.0
                    )
                    if tilt_angle_at < -2.05
                    else (
                        x2_
                        if 0.0 > (x2_ := 50.0 * (1.85 - tilt_angle_at) - 0.15 * tilt_speed_at)
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
                        if (x1_ := pan_torque_within + 0.0010289327 * pan_speed_at / 0.002)
                        < -0.015600000000000001
                        else 0.015600000000000001
                        if x1_ > 0.015600000000000001
                        else x1_
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
                        if (
                            x1_ := tilt_torque_within
                            + 0.00032893269999999996 * tilt_speed_at / 0.002
                        )
                        < -0.010400000000000001
                        else 0.010400000000000001
                        if x1_ > 0.010400000000000001
                        else x1_
                    )
                    if tilt_speed_at < 0.04 and tilt_speed_at > -0.04
                    else 0.008
                    if tilt_speed_at > 0.0
                    else -0.008
                )
                k2_pan_angle = pan_speed_at
                # plant.csp:48
                k2_pan_speed = (pan_torque_within - pan_friction_within) / 0.0010289327
                k2_tilt_angle = tilt_speed_at
                # plant.csp:48
                k2_tilt_speed = (tilt_torque_within - tilt_friction_within) / 0.00032893269999999996
                pan_angle_at = pan_angle + half * k2_pan_angle
                pan_speed_at = pan_speed + half * k2_pan_speed
                tilt_angle_at = tilt_angle + half * k2_tilt_angle
                tilt_speed_at = tilt_speed + half * k2_tilt_speed
                # plant.csp:35
                pan_stop_within = (
                    (
                        x1_
                        if 0.0 < (x1_ := 50.0 * (-1.62 - pan_angle_at) - 0.3 * pan_speed_at)
                        else 0.0
                    )
                    if pan_angle_at < -1.62
                    else (
                        x2_
                        if 0.0 > (x2_ := 50.0 * (1.5 - pan_angle_at) - 0.3 * pan_speed_at)
                        else 0.0
                    )
                    if pan_angle_at > 1.5
                    else 0.0
                )
                # plant.csp:35
                tilt_stop_within = (
                    (
                        x1_
                        if 0.0 < (x1_ := 50.0 * (-2.05 - tilt_angle_at) - 0.15 * tilt_speed_at)
                        else 0.0
                    )
                    if tilt_angle_at < -2.05
                    else (
                        x2_
                        if 0.0 > (x2_ := 50.0 * (1.85 - tilt_angle_at) - 0.15 * tilt_speed_at)
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
                        if (x1_ := pan_torque_within + 0.0010289327 * pan_speed_at / 0.002)
                        < -0.015600000000000001
                        else 0.015600000000000001
                        if x1_ > 0.015600000000000001
                        else x1_
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
                        if (
                            x1_ := tilt_torque_within
                            + 0.00032893269999999996 * tilt_speed_at / 0.002
                        )
                        < -0.010400000000000001
                        else 0.010400000000000001
                        if x1_ > 0.010400000000000001
                        else x1_
                    )
                    if tilt_speed_at < 0.04 and tilt_speed_at > -0.04
                    else 0.008
                    if tilt_speed_at > 0.0
                    else -0.008
                )
                k3_pan_angle = pan_speed_at
                # plant.csp:48
                k3_pan_speed = (pan_torque_within - pan_friction_within) / 0.0010289327
                k3_tilt_angle = tilt_speed_at
                # plant.csp:48
                k3_tilt_speed = (tilt_torque_within - tilt_friction_within) / 0.00032893269999999996
                pan_angle_at = pan_angle + h * k3_pan_angle
                pan_speed_at = pan_speed + h * k3_pan_speed
                tilt_angle_at = tilt_angle + h * k3_tilt_angle
                tilt_speed_at = tilt_speed + h * k3_tilt_speed
                # plant.csp:35
                pan_stop_within = (
                    (
                        x1_
                        if 0.0 < (x1_ := 50.0 * (-1.62 - pan_angle_at) - 0.3 * pan_speed_at)
                        else 0.0
                    )
                    if pan_angle_at < -1.62
                    else (
                        x2_
                        if 0.0 > (x2_ := 50.0 * (1.5 - pan_angle_at) - 0.3 * pan_speed_at)
                        else 0.0
                    )
                    if pan_angle_at > 1.5
                    else 0.0
                )
                # plant.csp:35
                tilt_stop_within = (
                    (
                        x1_
                        if 0.0 < (x1_ := 50.0 * (-2.05 - tilt_angle_at) - 0.15 * tilt_speed_at)
                        else 0.0
                    )
                    if tilt_angle_at < -2.05
                    else (
                        x2_
                        if 0.0 > (x2_ := 50.0 * (1.85 - tilt_angle_at) - 0.15 * tilt_speed_at)
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
                        if (x1_ := pan_torque_within + 0.0010289327 * pan_speed_at / 0.002)
                        < -0.015600000000000001
                        else 0.015600000000000001
                        if x1_ > 0.015600000000000001
                        else x1_
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
                        if (
                            x1_ := tilt_torque_within
                            + 0.00032893269999999996 * tilt_speed_at / 0.002
                        )
                        < -0.010400000000000001
                        else 0.010400000000000001
                        if x1_ > 0.010400000000000001
                        else x1_
                    )
                    if tilt_speed_at < 0.04 and tilt_speed_at > -0.04
                    else 0.008
                    if tilt_speed_at > 0.0
                    else -0.008
                )
                k4_pan_angle = pan_speed_at
                # plant.csp:48
                k4_pan_speed = (pan_torque_within - pan_friction_within) / 0.0010289327
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
            if not isfinite(pan_angle + pan_speed + tilt_angle + tilt_speed):
                finite(pan_angle)  # plant.csp:47
                finite(pan_speed)  # plant.csp:48
                finite(tilt_angle)  # plant.csp:47
                finite(tilt_speed)  # plant.csp:48
