"""The process Delta."""

from __future__ import annotations

from .runtime import In, Out, Process, Variable


class Delta(Process):
    """Copies each value to both outputs, one after the other.

    Source: commstime.csp:19

    Ports:
        input: in, int.
        first: out, int.
        second: out, int.
    """

    def __init__(self, name: str, *, input_: In[int], first: Out[int], second: Out[int]) -> None:
        super().__init__(name, source="commstime.csp:19")
        self.first = first
        self.second = second
        self.input_ = input_.reader(self)
        self.value = Variable[int](f"{name}.value")

    async def run(self) -> None:
        while True:
            self.value.value = await self.input_.read()  # commstime.csp:28
            await self.first.write(self.value.value)  # commstime.csp:28
            await self.second.write(self.value.value)  # commstime.csp:28
