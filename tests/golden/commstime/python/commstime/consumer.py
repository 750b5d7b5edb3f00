"""The process Consumer."""

from __future__ import annotations

from .exceptions import Finished
from .runtime import In, Process, Variable


class Consumer(Process):
    """Takes `rounds` values and ends the network.

    Source: commstime.csp:47

    Parameters:
        rounds: int.

    Ports:
        input: in, int.
    """

    def __init__(self, name: str, *, rounds: int, input_: In[int]) -> None:
        super().__init__(name, source="commstime.csp:47")
        self.rounds = rounds
        self.input_ = input_.reader(self)
        self.value = Variable[int](f"{name}.value")

    async def run(self) -> None:
        while True:
            self.value.value = await self.input_.read()  # commstime.csp:55
            if self.value.value == self.rounds - 1:
                break
        raise Finished  # commstime.csp:55
