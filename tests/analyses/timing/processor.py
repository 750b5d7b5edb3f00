"""A processor of ours that takes time: the runtime runs programs on a clock that stands still but for what laws compute
and for waiting.

So this is the real scheduler, the real order of ports, and the real composition.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from cspdiag import pipeline
from cspdiag.api import LoadedProgram
from cspdiag.base import SourceFile
from cspdiag.network.ir.network import Network, SubmodelClass
from cspdiag.runtime import Submodel
from cspdiag.simulate.result import Run
from cspdiag.simulate.run.execute import simulate
from cspdiag.simulate.run.probes import parts_of


class Processor:
    """A clock that goes on while laws compute, and jumps to what is waited for."""

    real = True
    present = 0

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


def read(path: str) -> SourceFile:
    raise FileNotFoundError(path)


def run(
    network: Network, times: Callable[[str], int], until: int, ended: Callable[[str, int], None] | None = None
) -> Run:
    """Run a program whose laws, by their paths, take some times; ``ended`` is told of each law that has computed, and
    when it began.
    """

    def slow(running: Any) -> None:
        def timed(path: str, calculate: Callable[..., Any]) -> Callable[..., Any]:
            def calculated(*inputs: Any) -> Any:
                began = Processor.present
                Processor.present += times(path)
                if ended is not None:
                    ended(path, began)
                return calculate(*inputs)

            return calculated

        for part in parts_of(running.process):
            if isinstance(part, Submodel):
                part.calculate = timed(part.name, part.calculate)  # type: ignore[attr-defined]

    found = simulate(network, pipeline.generate(network, read), until=until, real_time=True, on_start=slow)
    assert found.outcome.ended == "time limit", found.summary()
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
