"""The process Consumer."""

from __future__ import annotations

from .constants import items, producers
from .runtime import In, Out, Process, Variable, int64, ms, wait


class Consumer(Process):
    """Needs some time for each item.

    Source: buffer.csp:49

    Ports:
        item: in, int.
        done: out, int.
    """

    def __init__(self, name: str, *, item: In[int], done: Out[int]) -> None:
        super().__init__(name, source="buffer.csp:49")
        self.done = done
        self.item = item.reader(self)
        self.latest = Variable[int](f"{name}.latest")
        self.taken = Variable[int](f"{name}.taken", 0)

    async def run(self) -> None:
        while True:
            self.latest.value = await self.item.read()  # buffer.csp:59
            await wait(3 * ms)  # buffer.csp:59
            await self.done.write(self.latest.value)  # buffer.csp:59
            self.taken.value = int64(self.taken.value + 1)  # buffer.csp:59
            if self.taken.value == producers * items:
                break
