"""PyCSP 0.9 with greenlets, its faster implementation."""

from __future__ import annotations

import collections
import collections.abc
import sys
from typing import Any

from timing import leave, report, requested_benchmark, resident, size_of, timed_blocking

collections.Callable = collections.abc.Callable  # type: ignore[attr-defined]  # it was written for older Pythons

requested, sys.argv = requested_benchmark(), sys.argv[:1]  # it reads its own options from the command line
try:
    import pycsp.greenlets as pycsp
except ImportError:
    sys.exit(0)


def channel() -> tuple[Any, Any]:
    made = pycsp.Channel()
    return made.reader(), made.writer()


def parallel(*bodies: Any) -> None:
    pycsp.Parallel(*[pycsp.process(body)() for body in bodies])


def copies(source: Any, *sinks: Any, added: int = 0) -> Any:
    def body() -> None:
        while True:
            value = source()
            for sink in sinks:
                sink(value + added)

    return body


def measures(step: Any, count: int, divisor: int = 1) -> Any:
    def body() -> None:
        timed_blocking(step, count, divisor)
        leave()

    return body


def commstime() -> None:
    a, b, c, d = (channel() for _ in range(4))

    def prefix() -> None:
        a[1](0)
        copies(c[0], a[1])()

    parallel(prefix, copies(a[0], b[1], d[1]), copies(b[0], c[1], added=1), measures(d[0], 5000, 4))


def ring(size: int = 1000) -> None:
    channels = [channel() for _ in range(size)]

    def once() -> None:
        channels[0][1](1)
        channels[-1][0]()

    cells = [copies(channels[index - 1][0], channels[index][1]) for index in range(1, size)]
    parallel(measures(once, 20, size), *cells)


def parallel_of_two() -> None:
    def nothing() -> None:
        pass

    parallel(measures(lambda: parallel(nothing, nothing), 2000))


def memory(size: int = 2000) -> None:
    before = resident()
    channels = [channel() for _ in range(size)]

    def observer() -> None:
        for _ in range(3):
            parallel(lambda: None)
        report((resident() - before) / size)
        leave()

    parallel(*(copies(read) for read, _ in channels), observer)


def alternative(size: int) -> None:
    channels = [channel() for _ in range(size)]
    guards = [pycsp.InputGuard(read) for read, _ in channels]

    def writes(write: Any) -> Any:
        def body() -> None:
            while True:
                write(1)

        return body

    parallel(measures(lambda: pycsp.FairSelect(*guards), 1000), *(writes(write) for _, write in channels))


def main() -> None:
    match requested:
        case "commstime":
            commstime()
        case "ring":
            ring()
        case "parallel":
            parallel_of_two()
        case "memory":
            memory()
        case name:
            alternative(size_of(name))


pycsp.Parallel(pycsp.process(main)())
