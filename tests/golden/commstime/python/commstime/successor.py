"""The process Successor."""

from __future__ import annotations

from .runtime import In, Out, Process, Variable, int64


class Successor(Process):
    """Adds one.

    Source: commstime.csp:33

    Ports:
        input: in, int.
        output: out, int.
    """

    def __init__(self, name: str, *, input_: In[int], output: Out[int]) -> None:
        super().__init__(name, source="commstime.csp:33")
        self.output = output
        self.input_ = input_.reader(self)
        self.value = Variable[int](f"{name}.value")

    async def run(self) -> None:
        while True:
            self.value.value = await self.input_.read()  # commstime.csp:42
            await self.output.write(int64(self.value.value + 1))  # commstime.csp:42
