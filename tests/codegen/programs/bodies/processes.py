"""A hand-written process."""

from __future__ import annotations

from cspdiag.runtime import In, Out, Process


class Echo(Process):
    """Shows the button a few times."""

    def __init__(self, name: str, *, count: int, button: In[int], light: Out[int]) -> None:
        super().__init__(name, source="hardware.csp:24")
        self.count = count
        self.button = button.reader(self)
        self.light = light

    async def run(self) -> None:
        for _ in range(self.count):
            await self.light.write(await self.button.read())
