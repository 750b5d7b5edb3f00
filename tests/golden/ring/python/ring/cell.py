"""The process Cell."""

from __future__ import annotations

from .constants import laps
from .runtime import In, Out, Process, Variable, int64


class Cell(Process):
    """Passes the token on, one step older.

    Source: ring.csp:20

    Ports:
        input: in, int.
        output: out, int.
    """

    def __init__(self, name: str, *, input_: In[int], output: Out[int]) -> None:
        super().__init__(name, source="ring.csp:20")
        self.output = output
        self.input_ = input_.reader(self)
        self.token = Variable[int](f"{name}.token")
        self.lap = Variable[int](f"{name}.lap", 0)

    async def run(self) -> None:
        while True:
            self.token.value = await self.input_.read()  # ring.csp:30
            await self.output.write(int64(self.token.value + 1))  # ring.csp:30
            self.lap.value = int64(self.lap.value + 1)  # ring.csp:30
            if self.lap.value == laps:
                break
