"""trio: memory channels without a buffer."""

from __future__ import annotations

import sys
from typing import Any

import async_programs
from timing import requested_benchmark

try:
    import trio
except ImportError:
    sys.exit(0)


def channel() -> tuple[Any, Any]:
    send, receive = trio.open_memory_channel(0)
    return receive.receive, send.send


async def parallel(*bodies: Any) -> None:
    async def run(body: Any) -> None:
        await body

    async with trio.open_nursery() as nursery:
        for body in bodies:
            nursery.start_soon(run, body)


def main(name: str) -> None:
    match name:
        case "commstime":
            trio.run(async_programs.commstime, channel, parallel, 3000)
        case "ring":
            trio.run(async_programs.ring, channel, parallel, 10)
        case "parallel":
            trio.run(async_programs.parallel_of_two, parallel, 2000)
        case "memory":
            trio.run(async_programs.memory, channel, parallel, lambda: trio.sleep(0))
        case _:
            sys.exit(f"unknown benchmark: {name}")


main(requested_benchmark())
