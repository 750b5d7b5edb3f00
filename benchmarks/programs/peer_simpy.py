"""simpy: stores with one place."""

from __future__ import annotations

import sys
import time
from collections.abc import Generator
from typing import Any

from timing import BATCHES, leave, report, requested_benchmark, resident

try:
    import simpy
except ImportError:
    sys.exit(0)

world = simpy.Environment()


def store() -> Any:
    return simpy.Store(world, 1)


def batches(step: Any, count: int, divisor: int = 1) -> Generator[Any, Any, Any]:
    for _ in range(count // 10):
        yield from step()
    for _ in range(BATCHES):
        began = time.perf_counter_ns()
        for _ in range(count):
            yield from step()
        report((time.perf_counter_ns() - began) / count / divisor)
    leave()


def copies(source: Any, *sinks: Any, added: int = 0) -> Generator[Any, Any, Any]:
    while True:
        value = yield source.get()
        for sink in sinks:
            yield sink.put(value + added)


def commstime() -> None:
    a, b, c, d = store(), store(), store(), store()

    def prefix() -> Generator[Any, Any, Any]:
        yield a.put(0)
        yield from copies(c, a)

    def take() -> Generator[Any, Any, Any]:
        yield d.get()

    for body in (prefix(), copies(a, b, d), copies(b, c, added=1), batches(take, 5000, 4)):
        world.process(body)


def ring(size: int = 1000) -> None:
    stores = [store() for _ in range(size)]

    def once() -> Generator[Any, Any, Any]:
        yield stores[0].put(1)
        yield stores[-1].get()

    for index in range(1, size):
        world.process(copies(stores[index - 1], stores[index]))
    world.process(batches(once, 20, size))


def parallel() -> None:
    def nothing() -> Generator[Any, Any, Any]:
        return
        yield

    def both() -> Generator[Any, Any, Any]:
        yield world.process(nothing()) & world.process(nothing())

    world.process(batches(both, 5000))


def memory(size: int = 10_000) -> None:
    before = resident()
    for _ in range(size):
        world.process(copies(store()))
    world.run(until=1)
    report((resident() - before) / size)
    leave()


def delay(count: int = 3000) -> None:
    def process(period: int) -> Generator[Any, Any, Any]:
        while True:
            yield world.timeout(period)

    for index in range(10):
        world.process(process(1000 + index))
    for batch in range(1, BATCHES + 1):
        began = time.perf_counter_ns()
        world.run(until=batch * count * 1000)
        report((time.perf_counter_ns() - began) / count / 10)
    leave()


{"commstime": commstime, "ring": ring, "parallel": parallel, "memory": memory, "delay": delay}[requested_benchmark()]()
world.run()
