"""Functions that the programs share."""

from __future__ import annotations

import gc
import sys
import time
from collections.abc import Awaitable, Callable

BATCHES = 3


def requested_benchmark() -> str:
    """The benchmark that this run is for."""
    return sys.argv[1]


def size_of(name: str) -> int:
    """The number at the end of the name of a benchmark."""
    return int(name.rpartition("-")[2])


def resident() -> int:
    """Bytes of memory of this process."""
    gc.collect()
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * 4096


def report(nanoseconds: float) -> None:
    print(f"{nanoseconds:.2f}", flush=True)


def leave() -> None:
    """End immediately: what was measured never ends by itself."""
    import os

    sys.stdout.flush()
    os._exit(0)


async def timed(step: Callable[[], Awaitable[object]], count: int, divisor: int = 1) -> None:
    """Repeat ``step`` and report nanoseconds for each of its ``divisor`` parts, once for every batch."""
    for _ in range(count // 10):
        await step()
    for _ in range(BATCHES):
        began = time.perf_counter_ns()
        for _ in range(count):
            await step()
        report((time.perf_counter_ns() - began) / count / divisor)


def timed_blocking(step: Callable[[], object], count: int, divisor: int = 1) -> None:
    """``timed`` for libraries whose operations block."""
    for _ in range(count // 10):
        step()
    for _ in range(BATCHES):
        began = time.perf_counter_ns()
        for _ in range(count):
            step()
        report((time.perf_counter_ns() - began) / count / divisor)
