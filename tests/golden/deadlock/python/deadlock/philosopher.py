"""The process Philosopher."""

from __future__ import annotations

from .constants import meals
from .runtime import Out, Process, Variable, int64, ms, wait


class Philosopher(Process):
    """Thinks, takes a fork, takes the other, eats, puts both back.

    Source: table.csp:24

    Parameters:
        id: int.

    Ports:
        first: out, int.
        second: out, int.
    """

    def __init__(self, name: str, *, id_: int, first: Out[int], second: Out[int]) -> None:
        super().__init__(name, source="table.csp:24")
        self.id_ = id_
        self.first = first
        self.second = second
        self.eaten = Variable[int](f"{name}.eaten", 0)

    async def run(self) -> None:
        while self.eaten.value < meals:
            await wait(10 * ms)  # table.csp:33
            await self.first.write(self.id_)  # table.csp:34
            await self.second.write(self.id_)  # table.csp:35
            await wait(20 * ms)  # table.csp:36
            await self.first.write(self.id_)  # table.csp:37
            await self.second.write(self.id_)  # table.csp:38
            self.eaten.value = int64(self.eaten.value + 1)  # table.csp:39
