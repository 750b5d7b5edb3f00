"""The environment Workshop."""

from __future__ import annotations

from collections.abc import Mapping

from ..runtime import Driver, Signal, finite, ms, s
from ..types import Button

wheel_inertia = 2e-4  # emergency.csp:43


class Workshop:
    """The environment Workshop.

    Source: emergency.csp:62
    """

    step = 2 * ms
    on_miss = "timeout"

    def __init__(self) -> None:
        self.now = 0
        self.panel = Signal[Button](Button.none)
        self.feedback = Signal[float](0.0)
        self.control = Signal[float](0.0)
        self.brake = Signal[bool](False)
        self.halted = Signal[bool](False)
        self.drivers: Mapping[str, Driver] = {
            "panel": self.panel,
            "feedback": self.feedback,
            "control": self.control,
            "brake": self.brake,
            "halted": self.halted,
        }

    def start(self) -> None:
        """Go to time 0 and evaluate the outputs."""
        self.now = 0
        self.wheel_w = 0.0
        self._evaluate()

    def advance(self, now: int) -> None:
        """Integrate to `now` (in nanoseconds) with the inputs held, and evaluate the outputs."""
        control = self.control.value
        brake = self.brake.value
        wheel_w = self.wheel_w
        wheel_voltage = control  # emergency.csp:68
        wheel_brake = brake  # emergency.csp:69
        h = (now - self.now) / s
        half = h / 2
        sixth = h / 6
        k1 = self._derivative(wheel_w, wheel_voltage, wheel_brake)
        k2 = self._derivative(wheel_w + half * k1, wheel_voltage, wheel_brake)
        k3 = self._derivative(wheel_w + half * k2, wheel_voltage, wheel_brake)
        k4 = self._derivative(wheel_w + h * k3, wheel_voltage, wheel_brake)
        wheel_w += sixth * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        self.wheel_w = finite(wheel_w)  # emergency.csp:51
        self.now = now
        self._evaluate()

    def _evaluate(self) -> None:
        time = self.now / s
        wheel_speed = self.wheel_w  # emergency.csp:52
        # emergency.csp:59
        operator_button = (
            Button.none if time < 0.1 else Button.start if time < 0.9 else Button.emergency
        )
        self.panel.value = operator_button  # emergency.csp:66
        self.feedback.value = wheel_speed  # emergency.csp:67

    def _derivative(self, wheel_w: float, wheel_voltage: float, wheel_brake: bool) -> float:
        wheel_motor = 0.05 * (wheel_voltage - 0.05 * wheel_w) / 1.0  # emergency.csp:49
        wheel_braked = 0.002 * wheel_w if wheel_brake else 0.0  # emergency.csp:50
        return (wheel_motor - wheel_braked) / wheel_inertia  # emergency.csp:51
