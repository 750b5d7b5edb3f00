"""The submodel CurrentController."""

from __future__ import annotations

from .runtime import In, Out, Submodel, finite, limit, read_all


class CurrentController(Submodel):
    """PI whose integral stands still while the output is limited.

    Source: cascade.csp:7

    Parameters:
        kp: double<V/A>.
        ki: double<V/A/s>.
        voltage: double<V>.
        sample: the sample period in seconds.

    Ports:
        reference: in, double<A>.
        current: in, double<A>.
        control: out, double<V>.
    """

    def __init__(
        self,
        name: str,
        *,
        kp: float,
        ki: float,
        voltage: float,
        sample: float,
        reference: In[float],
        current: In[float],
        control: Out[float],
    ) -> None:
        super().__init__(name, source="cascade.csp:7")
        self.reference = reference
        self.current = current
        self.control = control
        self.kp = kp
        self.ki = ki
        self.voltage = voltage
        self.sample = sample
        self.reset()

    def reset(self) -> None:
        self.ui = 0.0

    async def run(self) -> None:
        reference, current = await read_all(self.reference, self.current)
        control = self.calculate(reference, current)
        await self.control.write(control)

    def calculate(self, reference: float, current: float) -> float:
        ui = self.ui
        voltage = self.voltage
        error = reference - current  # cascade.csp:12
        i = ui + self.sample * self.ki * error  # cascade.csp:13
        sum_ = self.kp * error + i  # cascade.csp:14
        control = finite(limit(sum_, -voltage, voltage))  # cascade.csp:15
        ui_next = finite(i if sum_ == control else ui)  # cascade.csp:16
        self.ui = ui_next  # cascade.csp:16
        return control
