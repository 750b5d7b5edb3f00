"""asyncio: queues with one place."""

from __future__ import annotations

import asyncio
from typing import Any

import async_programs
from timing import leave, requested_benchmark, size_of, timed


def channel() -> tuple[Any, Any]:
    queue: asyncio.Queue[int] = asyncio.Queue(1)
    return queue.get, queue.put


async def parallel(*bodies: Any) -> None:
    await asyncio.gather(*bodies)


async def alternative(size: int) -> None:
    """The usual way: a task waits for each queue, and the first one to complete is chosen."""
    queues: list[asyncio.Queue[int]] = [asyncio.Queue(1) for _ in range(size)]

    async def writer(queue: asyncio.Queue[int]) -> None:
        while True:
            await queue.put(1)

    async def reader() -> None:
        tasks = {asyncio.ensure_future(queue.get()): queue for queue in queues}
        done: list[Any] = []

        async def select() -> Any:
            if not done:
                finished, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
                done.extend(finished)
            task = done.pop()
            queue = tasks.pop(task)
            tasks[asyncio.ensure_future(queue.get())] = queue
            return task.result()

        await timed(select, 3000)
        leave()

    await parallel(reader(), *(writer(queue) for queue in queues))


def main(name: str) -> None:
    match name:
        case "commstime":
            asyncio.run(async_programs.commstime(channel, parallel, 5000))
        case "ring":
            asyncio.run(async_programs.ring(channel, parallel, 20))
        case "parallel":
            asyncio.run(async_programs.parallel_of_two(parallel, 3000))
        case "memory":
            asyncio.run(async_programs.memory(channel, parallel, lambda: asyncio.sleep(0)))
        case _:
            asyncio.run(alternative(size_of(name)))


main(requested_benchmark())
