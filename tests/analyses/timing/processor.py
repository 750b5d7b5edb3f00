"""A test processor that takes time: the runtime runs programs on a clock that advances only while laws compute and
processes wait.

So this is the real scheduler, the real order of ports, and the real composition. An instant is executed when the clock
reaches it, even while a law computes, and before anything else that happens at this instant: a law that ends at a tick
writes after the tick.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, ClassVar

import cspdiag.runtime.advance.run
import cspdiag.runtime.network
from cspdiag import pipeline
from cspdiag.api import LoadedProgram
from cspdiag.base import SourceFile
from cspdiag.network.ir.network import Network, SubmodelClass
from cspdiag.runtime import Submodel
from cspdiag.simulate.result import Run
from cspdiag.simulate.run.execute import simulate
from cspdiag.simulate.run.probes import parts_of


class TimeIsUp(Exception):  # noqa: N818 - it says what is the case
    """The time limit has passed. A process that finds each sample when it needs it never waits, and the runtime checks
    the limit only between steps.
    """


class _Run(cspdiag.runtime.advance.run.NetworkRun):
    """A run that executes its instants while laws compute."""

    def start(self) -> None:
        Processor.run = self
        super().start()

    def compute(self, duration: int) -> None:
        Processor.present += duration
        while (instant := self._next_instant()) is not None and instant <= Processor.present:
            if self._until is not None and instant > self._until:
                raise TimeIsUp
            self._meet(instant, instant)
        self._scheduler.now = Processor.present


class Processor:
    """A clock that advances while laws compute, and jumps to the next instant that is waited for."""

    real = True
    present = 0
    run: ClassVar[_Run]

    def start(self) -> None:
        Processor.present = 0

    def now(self) -> int:
        return Processor.present

    def reach(self, instant: int | None) -> bool:
        assert instant is not None
        Processor.present = max(Processor.present, instant)
        return True

    def notify(self) -> None:
        raise AssertionError("nothing comes from outside")

    @classmethod
    def compute(cls, duration: int) -> None:
        """Let the running law take this duration."""
        cls.run.compute(duration)


@contextmanager
def on_processor() -> Iterator[None]:
    """Within this context, programs that run in real time run on this processor."""
    runtime = cspdiag.runtime.network
    kept = runtime.RealClock, runtime.NetworkRun
    runtime.RealClock, runtime.NetworkRun = Processor, _Run  # type: ignore[misc, assignment]
    try:
        yield
    finally:
        runtime.RealClock, runtime.NetworkRun = kept  # type: ignore[misc]


def read(path: str) -> SourceFile:
    raise FileNotFoundError(path)


def run(
    network: Network, times: Callable[[str], int], until: int, ended: Callable[[str, int], None] | None = None
) -> Run:
    """Run a program whose laws take the given times, by their paths; ``ended`` is called with each law that has
    computed, and when it began.
    """

    def slow(running: Any) -> None:
        def timed(path: str, calculate: Callable[..., Any]) -> Callable[..., Any]:
            def calculated(*inputs: Any) -> Any:
                began = Processor.present
                Processor.compute(times(path))
                if ended is not None:
                    ended(path, began)
                return calculate(*inputs)

            return calculated

        for part in parts_of(running.process):
            if isinstance(part, Submodel):
                part.calculate = timed(part.name, part.calculate)  # type: ignore[attr-defined]

    found = simulate(network, pipeline.generate(network, read), until=until, real_time=True, on_start=slow)
    assert found.outcome.ended == "time limit" or isinstance(found.outcome.error, TimeIsUp), found.summary()
    assert not any(found.outcome.missed.values())
    return found


def longest(network: Network, times: Callable[[str], int], periods: Mapping[str, int], until: int) -> dict[str, int]:
    """The longest time from the tick of a sample to the end of each law in a run."""
    found: dict[str, int] = {}

    def ended(path: str, began: int) -> None:
        release = began // periods[path] * periods[path]
        found[path] = max(found.get(path, 0), Processor.present - release)

    run(network, times, until, ended)
    return found


def wcets(network: Network) -> dict[str, int]:
    found = {}
    for instance in network.instances:
        entry = network.class_named(instance.class_name)
        if isinstance(entry, SubmodelClass) and entry.wcet is not None:
            found[instance.path] = entry.wcet
    return found


def with_bench(text: str, ports: list[str], outputs: list[str], grid: str) -> Network:
    source = " ".join(f"{port} = time / 1 s" for port in ports)
    wires = " ".join(f"source.{port} -> {port}" for port in ports) + " " + " ".join(f"{port} -> _" for port in outputs)
    bench = f"""
        submodel Source {{ out {", ".join(ports)} : double {source} }}
        environment Bench for Main step {grid} {{ source : Source {wires} }}
        """
    return LoadedProgram(SourceFile(name="main.csp", text=text + bench)).network
