"""The process CurrentLoop."""

from __future__ import annotations

from .current_controller import CurrentController
from .runtime import Alternative, In, Input, Out, Process, Ready, Variable


class CurrentLoop(Process):
    """Inner loop: ten samples of the current for each new reference.

    Source: cascade.csp:33

    Ports:
        reference: in, double<A>.
        current: in, double<A> @ Tcurrent.
        voltage: out, double<V> @ Tcurrent.
    """

    def __init__(
        self,
        name: str,
        *,
        reference: In[float],
        current: In[float],
        voltage: Out[float],
    ) -> None:
        super().__init__(name, source="cascade.csp:33")
        self.reference = reference.reader(self)
        self.current = current.reader(self)
        self.target = Variable[float](f"{name}.target", 0.0)
        self.law = CurrentController(
            f"{name}.law",
            kp=2.0,
            ki=2000.0,
            voltage=24.0,
            sample=0.0001,
            reference=self.target,
            current=self.current,
            control=voltage,
        )
        self.choice = Alternative(Input(self.reference), Ready(self.current), prioritized=True)

    async def run(self) -> None:
        while True:
            match await self.choice.select():  # cascade.csp:48
                case 0:  # reference ? target
                    self.target.value = self.choice.value
                case 1:  # current
                    await self.law
