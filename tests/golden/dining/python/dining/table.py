"""The process Table."""

from __future__ import annotations

from .fork import Fork
from .philosopher import Philosopher
from .runtime import Channel, Process, parallel


class Table(Process):
    """The last philosopher takes the right fork first, so that no circle of waiting can close.

    Source: dining.csp:4
    """

    def __init__(self, name: str) -> None:
        super().__init__(name, source="dining.csp:4")
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
                f"{name}.fork[0]", left=self.philosopher_first[0], right=self.philosopher_first[4]
            ),
            *(
                Fork(
                    f"{name}.fork[{i}]",
                    left=self.philosopher_first[i],
                    right=self.philosopher_second[i - 1],
                )
                for i in range(1, 4)
            ),
            Fork(
                f"{name}.fork[4]", left=self.philosopher_second[4], right=self.philosopher_second[3]
            ),
        ]

    async def run(self) -> None:
        await parallel(parallel(*self.philosopher), parallel(*self.fork))
