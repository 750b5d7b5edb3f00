"""The process SpeedLoop."""

from __future__ import annotations

from .runtime import In, Out, Process
from .speed_controller import SpeedController


class SpeedLoop(Process):
    """Outer loop.

    Source: cascade.csp:53

    Ports:
        reference: in, double<rad/s> @ Tspeed.
        speed: in, double<rad/s> @ Tspeed.
        current: out, double<A>.
    """

    def __init__(
        self,
        name: str,
        *,
        reference: In[float],
        speed: In[float],
        current: Out[float],
    ) -> None:
        super().__init__(name, source="cascade.csp:53")
        self.reference = reference.reader(self)
        self.speed = speed.reader(self)
        self.law = SpeedController(
            f"{name}.law",
            kp=0.2,
            ki=4.0,
            current=4.0,
            sample=0.001,
            reference=self.reference,
            speed=self.speed,
            control=current,
        )

    async def run(self) -> None:
        while True:
            await self.law
