"""The submodel SpindleController."""

from __future__ import annotations

from .runtime import In, Out, Submodel, finite, limit


class SpindleController(Submodel):
    """Proportional law with the voltage that the speed induces added.

    Source: emergency.csp:8

    Parameters:
        speed: double<rad/s>.

    Ports:
        feedback: in, double<rad/s>.
        control: out, double<V>.
    """

    def __init__(
        self,
        name: str,
        *,
        speed: float,
        feedback: In[float],
        control: Out[float],
    ) -> None:
        super().__init__(name, source="emergency.csp:8")
        self.feedback = feedback
        self.control = control
        self.speed = speed

    async def run(self) -> None:
        feedback = await self.feedback.read()
        control = self.calculate(feedback)
        await self.control.write(control)

    def calculate(self, feedback: float) -> float:
        # emergency.csp:12
        return finite(limit(0.05 * feedback + 0.5 * (self.speed - feedback), -24.0, 24.0))
