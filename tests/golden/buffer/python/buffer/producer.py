"""The process Producer."""

from __future__ import annotations

from .constants import items
from .runtime import Out, Process, Variable, int64, wait


class Producer(Process):
    """Makes an item every `period`; the hundreds say which producer made it.

    Source: buffer.csp:7

    Parameters:
        id: int.
        period: time, in nanoseconds.

    Ports:
        item: out, int.
    """

    def __init__(self, name: str, *, id_: int, period: int, item: Out[int]) -> None:
        super().__init__(name, source="buffer.csp:7")
        self.id_ = id_
        self.period = period
        self.item = item
        self.made = Variable[int](f"{name}.made", 0)

    async def run(self) -> None:
        while self.made.value < items:
            await wait(self.period)  # buffer.csp:16
            await self.item.write(int64(100 * self.id_ + self.made.value))  # buffer.csp:17
            self.made.value = int64(self.made.value + 1)  # buffer.csp:18
