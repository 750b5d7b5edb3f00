"""cspdiag's runtime through its ``await`` interface."""

from __future__ import annotations

import time
from collections.abc import Awaitable, Callable
from typing import Any

import async_programs
from timing import BATCHES, asked, leave, report, size_of, timed

from cspdiag.runtime import Alternative, Channel, Input, Network, Process, parallel, wait


class Program(Process):
    def __init__(self, body: Callable[[], Awaitable[Any]]) -> None:
        super().__init__("benchmark")
        self.body = body

    async def run(self) -> None:
        await self.body()


def channel() -> tuple[Any, Any]:
    made = Channel[int]()
    return made.read, made.write


async def alternative(size: int) -> None:
    channels = [Channel[int](str(index)) for index in range(size)]
    choice = Alternative(*(Input(channel) for channel in channels))

    async def writer(channel: Channel[int]) -> None:
        while True:
            await channel.write(1)

    async def reader() -> None:
        await timed(choice.select, 20_000)
        leave()

    await parallel(reader(), *(writer(channel) for channel in channels))


async def delays() -> None:
    count = 3000

    async def process(period: int, last: bool) -> None:
        for _ in range(BATCHES):
            began = time.perf_counter_ns()
            for _ in range(count):
                await wait(period)
            if last:
                report((time.perf_counter_ns() - began) / count / 10)

    await parallel(*(process(1000 + index, index == 9) for index in range(10)))


def main(name: str) -> None:
    match name:
        case "commstime":
            body: Any = lambda: async_programs.commstime(channel, parallel, 50_000)  # noqa: E731
        case "ring":
            body = lambda: async_programs.ring(channel, parallel, 100)  # noqa: E731
        case "parallel":
            body = lambda: async_programs.parallel_of_two(parallel, 20_000)  # noqa: E731
        case "memory":
            body = lambda: async_programs.memory(channel, parallel, lambda: wait(1))  # noqa: E731
        case "delay":
            body = delays
        case _:
            body = lambda: alternative(size_of(name))  # noqa: E731
    outcome = Network(Program(body)).run()
    outcome.raise_if_unsuccessful()


main(asked())
