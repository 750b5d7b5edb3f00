"""The benchmarks for libraries with ``await``, in terms of a channel and a parallel composition."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from typing import Any

from timing import leave, report, resident, timed

Read = Callable[[], Awaitable[Any]]
Write = Callable[[Any], Awaitable[Any]]
NewChannel = Callable[[], tuple[Read, Write]]
Parallel = Callable[..., Awaitable[Any]]


async def commstime(channel: NewChannel, parallel: Parallel, count: int) -> None:
    (read_a, write_a), (read_b, write_b), (read_c, write_c), (read_d, write_d) = (channel() for _ in range(4))

    async def prefix() -> None:
        await write_a(0)
        while True:
            await write_a(await read_c())

    async def delta() -> None:
        while True:
            value = await read_a()
            await write_b(value)
            await write_d(value)

    async def successor() -> None:
        while True:
            await write_c(await read_b() + 1)

    async def consumer() -> None:
        await timed(read_d, count, 4)
        leave()

    await parallel(prefix(), delta(), successor(), consumer())


async def ring(channel: NewChannel, parallel: Parallel, rounds: int, size: int = 1000) -> None:
    channels = [channel() for _ in range(size)]

    async def cell(index: int) -> None:
        read, write = channels[index - 1][0], channels[index][1]
        while True:
            await write(await read())

    async def head() -> None:
        async def once() -> None:
            await channels[0][1](1)
            await channels[-1][0]()

        await timed(once, rounds, size)
        leave()

    await parallel(head(), *(cell(index) for index in range(1, size)))


async def parallel_of_two(parallel: Parallel, count: int) -> None:
    async def nothing() -> None:
        pass

    await timed(lambda: parallel(nothing(), nothing()), count)
    leave()


async def memory(
    channel: NewChannel, parallel: Parallel, yields: Callable[[], Awaitable[Any]], size: int = 10_000
) -> None:
    before = resident()
    channels = [channel() for _ in range(size)]

    async def reader(read: Read) -> None:
        while True:
            await read()

    async def observer() -> None:
        for _ in range(5):
            await yields()
        report((resident() - before) / size)
        leave()

    await parallel(*(reader(read) for read, _ in channels), observer())
