"""The process SymmetricTable."""

from __future__ import annotations

from .fork import Fork
from .philosopher import Philosopher
from .runtime import Channel, Process, parallel


class SymmetricTable(Process):
    """Every philosopher takes the left fork first: all hold one fork and wait for the other.

    Source: deadlock.csp:4
    """

    def __init__(self, name: str) -> None:
        super().__init__(name, source="deadlock.csp:4")
        self.philosopher_first = [Channel[int](f"{name}.philosopher[{i}].first") for i in range(5)]
        self.philosopher_second = [
            Channel[int](f"{name}.philosopher[{i}].second") for i in range(5)
        ]
        self.philosopher = [
            Philosopher(
                f"{name}.philosopher[{i}]",
                id_=i,
                first=self.philosopher_first[i],
                second=self.philosopher_second[i],
            )
            for i in range(5)
        ]
        self.fork = [
            Fork(
                f"{name}.fork[{i}]",
                left=self.philosopher_first[i],
                right=self.philosopher_second[(i + 4) % 5],
            )
            for i in range(5)
        ]

    async def run(self) -> None:
        await parallel(parallel(*self.philosopher), parallel(*self.fork))
