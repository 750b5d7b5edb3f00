"""The submodel VelocityController."""

from __future__ import annotations

from .runtime import In, Out, Submodel, finite, limit, s, sign, write_all


class VelocityController(Submodel):
    """Constant speed: PI on the filtered difference of the encoder, its output limited, so that it
    presses gently on the end stop. The end stop is the joint standing still for `dwell`
    although the controller drives with more than `effort`; `max` is where the joint is.

    Source: laws.csp:88

    Parameters:
        speed: double<rad/s>.
        kp: double<V*s/rad>.
        ki: double<V/rad>.
        pressure: double<V>.
        effort: double<V>.
        filter: time, in nanoseconds.
        dwell: time, in nanoseconds.
        sample: the sample period in seconds.

    Ports:
        feedback: in, double<rad>.
        control: out, double<V>.
        max: out, double<rad>.
        stop: out, bool.
    """

    def __init__(
        self,
        name: str,
        *,
        speed: float,
        kp: float,
        ki: float,
        pressure: float,
        effort: float,
        filter_: int,
        dwell: int,
        sample: float,
        feedback: In[float],
        control: Out[float],
        max_: Out[float],
        stop: Out[bool],
    ) -> None:
        super().__init__(name, source="laws.csp:88")
        self.feedback = feedback
        self.control = control
        self.max_ = max_
        self.stop = stop
        self.speed = speed
        self.kp = kp
        self.ki = ki
        self.pressure = pressure
        self.effort = effort
        self.filter_ = filter_ / s
        self.dwell = dwell / s
        self.sample = sample
        self.reset()

    def reset(self) -> None:
        self.moving = False
        self.last = 0.0
        self.filtered = 0.0
        self.ui = 0.0
        self.pressed = 0.0

    async def run(self) -> None:
        feedback = await self.feedback.read()
        control, max_, stop = self.calculate(feedback)
        await write_all((self.control, control), (self.max_, max_), (self.stop, stop))

    def calculate(self, feedback: float) -> tuple[float, float, bool]:
        filtered = self.filtered
        ui = self.ui
        speed = self.speed
        pressure = self.pressure
        sample = self.sample
        difference = (feedback - self.last) / sample if self.moving else 0.0  # laws.csp:103
        # laws.csp:104
        velocity = filtered + sample / (self.filter_ + sample) * (difference - filtered)
        error = speed - velocity  # laws.csp:105
        i = ui + sample * self.ki * error  # laws.csp:106
        sum_ = self.kp * error + i  # laws.csp:107
        control = finite(limit(sum_, -pressure, pressure))  # laws.csp:109
        # laws.csp:115
        pressing = abs(velocity) < 0.1 * abs(speed) and control * sign(speed) > self.effort
        held = self.pressed + sample if pressing else 0.0  # laws.csp:116
        stop = held >= self.dwell  # laws.csp:118
        max_ = feedback  # laws.csp:119
        filtered_next = finite(velocity)  # laws.csp:112
        ui_next = finite(i if sum_ == control else ui)  # laws.csp:113
        pressed_next = finite(held)  # laws.csp:117
        self.moving = True  # laws.csp:110
        self.last = feedback  # laws.csp:111
        self.filtered = filtered_next  # laws.csp:112
        self.ui = ui_next  # laws.csp:113
        self.pressed = pressed_next  # laws.csp:117
        return control, max_, stop
