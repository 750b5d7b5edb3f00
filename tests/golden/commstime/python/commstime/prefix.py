"""The process Prefix."""

from __future__ import annotations

from .runtime import In, Out, Process, Variable


class Prefix(Process):
    """Sends a first value and copies everything that follows.

    Source: commstime.csp:5

    Parameters:
        first: int.

    Ports:
        input: in, int.
        output: out, int.
    """

    def __init__(self, name: str, *, first: int, input_: In[int], output: Out[int]) -> None:
        super().__init__(name, source="commstime.csp:5")
        self.output = output
        self.input_ = input_.reader(self)
        self.value = Variable[int](f"{name}.value", first)

    async def run(self) -> None:
        while True:
            await self.output.write(self.value.value)  # commstime.csp:14
            self.value.value = await self.input_.read()  # commstime.csp:14
