"""A millisecond of JIWY in microseconds: ``fmus.py fmu-step native``, or with its plant as an FMU: ``c``, ``python``.

``fmpy`` is what fmpy takes for a step of the Reference FMU VanDerPol, with its outputs read; the variable
``CSPDIAG_REFERENCE_FMUS`` names the folder with the Reference FMUs.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from timing import BATCHES, report

from cspdiag import pipeline
from cspdiag.base.sources import read_source
from cspdiag.cli.main import main as cspdiag
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.simulate.native.build import CompilerError
from cspdiag.simulate.native.run import build_program
from cspdiag.simulate.result import Run
from cspdiag.simulate.run import execute

JIWY = Path(__file__).parents[2] / "models/jiwy/jiwy.csp"
STEPS = 20_000
ROUNDS = 5
"""The shortest of these runs counts."""


def network_of(folder: Path, *, with_fmu: bool) -> CoreNetwork:
    """JIWY with the plant of the text, or with that plant as an FMU."""
    plain = pipeline.build(read_source(str(JIWY)), read_source).network
    assert plain is not None
    if not with_fmu:
        return plain
    options = ["--target", "fmu", "--environment", "Bench", "-O1", "-o", str(folder)]
    if cspdiag(["compile", str(JIWY), *options]) != 0:
        sys.exit(0)
    wires = [
        f"plant.{port.name} -> {port.name}" if port.direction == "in" else f"{port.name} -> plant.{port.name}"
        for port in plain.external_ports
    ]
    text = (
        f'import "{JIWY}"\nsubmodel Plant fmu "jiwy_bench.fmu" {{}}\n'
        f"environment Modelled for Jiwy step 1 ms {{\n  plant : Plant\n  {chr(10).join(wires)}\n}}\n"
    )
    (folder / "modelled.csp").write_text(text)
    built = pipeline.build(read_source(str(folder / "modelled.csp")), read_source, environment="Modelled")
    assert built.network is not None, built.checked.report.diagnostics
    return built.network


def report_runs(run: Callable[[int], Run]) -> None:
    """The microseconds of a millisecond in the ten seconds after the first: loading the FMU does not count."""
    for _ in range(BATCHES):
        short, long = (min(run(until).outcome.wall_time for _ in range(ROUNDS)) for until in (10**9, 11 * 10**9))
        report((long - short) / 10_000 * 1e6)


def natively(folder: Path, *, with_fmu: bool) -> None:
    network = network_of(folder, with_fmu=with_fmu)
    environment = "Modelled" if with_fmu else "Bench"
    try:
        program = build_program(network, read_source, level=1, environment=environment)
    except CompilerError:
        sys.exit(0)
    report_runs(lambda until: program.run(observed="none", until=until))


def in_python(folder: Path) -> None:
    network = network_of(folder, with_fmu=True)
    files = pipeline.generate(network, read_source, level=1)
    report_runs(lambda until: execute.simulate(network, files, environment="Modelled", until=until))


def by_fmpy() -> None:
    place = Path(os.environ.get("CSPDIAG_REFERENCE_FMUS", "")) / "2.0" / "VanDerPol.fmu"
    if not place.is_file():
        sys.exit(0)
    import fmpy
    from fmpy.fmi2 import FMU2Slave

    about = fmpy.read_model_description(place)
    fmu = FMU2Slave(
        guid=about.guid,
        unzipDirectory=fmpy.extract(place),
        modelIdentifier=about.coSimulation.modelIdentifier,
        instanceName="one",
    )
    fmu.instantiate()
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    outputs = [variable.valueReference for variable in about.modelVariables if variable.causality == "output"]
    step = 0
    for _ in range(BATCHES):
        began = time.perf_counter_ns()
        for _ in range(STEPS):
            fmu.doStep(step * 0.01, 0.01)
            fmu.getReal(outputs)
            step += 1
        report((time.perf_counter_ns() - began) / STEPS / 1e3)


def main(contestant: str) -> None:
    if contestant == "fmpy":
        by_fmpy()
        return
    with tempfile.TemporaryDirectory() as name:
        if contestant == "python":
            in_python(Path(name))
        else:
            natively(Path(name), with_fmu=contestant == "c")


main(sys.argv[2])
