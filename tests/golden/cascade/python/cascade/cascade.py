"""The process Cascade."""

from __future__ import annotations

from .current_loop import CurrentLoop
from .runtime import Channel, In, Out, Process, prioritized_parallel
from .speed_loop import SpeedLoop


class Cascade(Process):
    """The current loop, which is the faster one, has the higher priority.

    Source: cascade.csp:72

    Ports:
        reference: in, double<rad/s> @ Tspeed.
        speed: in, double<rad/s> @ Tspeed.
        current: in, double<A> @ Tcurrent.
        voltage: out, double<V> @ Tcurrent.
    """

    def __init__(
        self,
        name: str,
        *,
        reference: In[float],
        speed: In[float],
        current: In[float],
        voltage: Out[float],
    ) -> None:
        super().__init__(name, source="cascade.csp:72")
        self.wanted = Channel[float](f"{name}.wanted")
        self.outer = SpeedLoop(
            f"{name}.outer", reference=reference, speed=speed, current=self.wanted
        )
        self.inner = CurrentLoop(
            f"{name}.inner", reference=self.wanted, current=current, voltage=voltage
        )

    async def run(self) -> None:
        await prioritized_parallel(self.inner, self.outer)
