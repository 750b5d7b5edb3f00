"""The submodel SpeedController."""

from __future__ import annotations

from .runtime import In, Out, Submodel, finite, limit, read_all


class SpeedController(Submodel):
    """PI whose output, the current requested of the motor, is limited.

    Source: cascade.csp:20

    Parameters:
        kp: double<A*s/rad>.
        ki: double<A/rad>.
        current: double<A>.
        sample: the sample period in seconds.

    Ports:
        reference: in, double<rad/s>.
        speed: in, double<rad/s>.
        control: out, double<A>.
    """

    def __init__(
        self,
        name: str,
        *,
        kp: float,
        ki: float,
        current: float,
        sample: float,
        reference: In[float],
        speed: In[float],
        control: Out[float],
    ) -> None:
        super().__init__(name, source="cascade.csp:20")
        self.reference = reference
        self.speed = speed
        self.control = control
        self.kp = kp
        self.ki = ki
        self.current = current
        self.sample = sample
        self.reset()

    def reset(self) -> None:
        self.ui = 0.0

    async def run(self) -> None:
        reference, speed = await read_all(self.reference, self.speed)
        control = self.calculate(reference, speed)
        await self.control.write(control)

    def calculate(self, reference: float, speed: float) -> float:
        ui = self.ui
        current = self.current
        error = reference - speed  # cascade.csp:25
        i = ui + self.sample * self.ki * error  # cascade.csp:26
        sum_ = self.kp * error + i  # cascade.csp:27
        control = finite(limit(sum_, -current, current))  # cascade.csp:28
        ui_next = finite(i if sum_ == control else ui)  # cascade.csp:29
        self.ui = ui_next  # cascade.csp:29
        return control
