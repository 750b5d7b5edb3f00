"""The process Starter."""

from __future__ import annotations

from .constants import laps
from .runtime import In, Out, Process, Variable, int64


class Starter(Process):
    """Sends the token on its way and takes it back after each lap.

    Source: ring.csp:5

    Ports:
        input: in, int.
        output: out, int.
    """

    def __init__(self, name: str, *, input_: In[int], output: Out[int]) -> None:
        super().__init__(name, source="ring.csp:5")
        self.output = output
        self.input_ = input_.reader(self)
        self.token = Variable[int](f"{name}.token", 0)
        self.lap = Variable[int](f"{name}.lap", 0)

    async def run(self) -> None:
        while True:
            await self.output.write(self.token.value)  # ring.csp:15
            self.token.value = await self.input_.read()  # ring.csp:15
            self.lap.value = int64(self.lap.value + 1)  # ring.csp:15
            if self.lap.value == laps:
                break
