"""Programs with known timing, put together from processes."""

from __future__ import annotations

from collections.abc import Mapping

from cspdiag.analyses.timing.report.timing import timing_report
from cspdiag.analyses.timing.result import LoopTiming, TimingReport
from cspdiag.api import LoadedProgram
from cspdiag.base import SourceFile
from cspdiag.network.ir.network import Network

US = 1000
MS = 1_000_000


def law(name: str, wcet: str | None, inputs: str = "x", outputs: str = "y") -> str:
    """A submodel with this execution time."""
    clause = "" if wcet is None else f"wcet {wcet} "
    equations = "\n".join(f"  {output.strip()} = 2 * {inputs.partition(',')[0]}" for output in outputs.split(","))
    return f"submodel {name} {clause}{{\n  in  {inputs} : double\n  out {outputs} : double\n{equations}\n}}\n"


def loops_of(*loops: tuple[str, str, str | None], order: str = "||", latch: str = "") -> str:
    """A program of independent sampled loops: name, period and execution time of each."""
    laws = "".join(law(f"Law_{name}", wcet) for name, _, wcet in loops)
    ports = "".join(f"  in  x_{n} : double @ {t}\n  out y_{n} : double @ {t} {latch}\n" for n, t, _ in loops)
    parts = "".join(f"    {n} : Law_{n}\n    x_{n} -> {n}.x\n    {n}.y -> y_{n}\n" for n, _, _ in loops)
    runs = f" {order} ".join(f"mu {n}" for n, _, _ in loops)
    return f"{laws}process Main {{\n{ports}  communication {{\n{parts}  }}\n  composition {{ {runs} }}\n}}\n"


def network_of(text: str) -> Network:
    """The network of a program text."""
    return LoadedProgram(SourceFile(name="main.csp", text=text)).network


def report_of(text: str, measured: Mapping[str, int] | None = None) -> TimingReport:
    """The timing of a program text."""
    return timing_report(network_of(text), measured)


def by_name(report: TimingReport) -> dict[str, LoopTiming]:
    """The loops of a program by name."""
    return {loop.name: loop for loop in report.loops}
