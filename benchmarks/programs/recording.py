"""JIWY recorded against JIWY not recorded, one after the other: ``recording.py recording-npz python``, or ``c``.

A figure is how many times as long a run takes whose recording is written to a new file, in the format that the name of
the benchmark ends with: MCAP while it runs, as ``cspdiag run --record`` does, the others after it. Neither compiling
nor the import of numpy counts.
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy  # noqa: F401 - its import takes longer than a run
from timing import report

from cspdiag import pipeline
from cspdiag.base.sources import read_source
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.simulate.native.build import CompilerError
from cspdiag.simulate.native.run import build_program
from cspdiag.simulate.record.recorder import Recorder
from cspdiag.simulate.record.stored.described import head_of
from cspdiag.simulate.record.streamed.formats import open_writer
from cspdiag.simulate.record.streamed.recording import Recording
from cspdiag.simulate.result import Run
from cspdiag.simulate.run import execute

JIWY = Path(__file__).parents[2] / "models/jiwy/jiwy.csp"
BATCHES = {"python": 5, "c": 15}
"""How often both are run."""

Simulate = Callable[[bool, Recording | None], tuple[Run, float]]
"""Runs the program, recorded or not, and as it runs into a recording; returns when the run began, too."""


def in_python(network: CoreNetwork) -> Simulate:
    files = pipeline.generate(network, read_source, level=1, observed=True)
    ports = {f"{network.top}.{port.name}": port.type for port in network.external_ports}

    def simulate(recorded: bool, recording: Recording | None) -> tuple[Run, float]:
        began: list[float] = []
        run = execute.simulate(
            network,
            files,
            recorder=Recorder(communications=recorded, ports=ports if recorded else None),
            on_start=lambda _: began.append(time.perf_counter()),
            recording=recording,
        )
        return run, began[0]

    return simulate


def in_c(network: CoreNetwork) -> Simulate:
    try:
        program = build_program(network, read_source, level=1)
    except CompilerError:
        sys.exit(0)

    def simulate(recorded: bool, recording: Recording | None) -> tuple[Run, float]:
        began = time.perf_counter()
        return program.run(observed="signals" if recorded else "none", recording=recording), began

    return simulate


def seconds(network: CoreNetwork, simulate: Simulate, path: Path | None) -> float:
    """How long a run takes, with the recording of it in a file."""
    streamed = None
    if path is not None and path.suffix == ".mcap":
        head = head_of(network, network.environments[0])
        streamed = Recording(head, open_writer(str(path), head), on_problem=lambda *_: None)
    run, began = simulate(path is not None, streamed)
    if streamed is not None:
        streamed.finish(run.outcome.ended, run.outcome.time, run.releases)
    elif path is not None:
        (run.to_npz if path.suffix == ".npz" else run.to_csv)(path)
    taken = time.perf_counter() - began
    assert run.outcome.ended == "terminated", run.outcome
    return taken


def main(name: str, target: str) -> None:
    network = pipeline.build(read_source(str(JIWY)), read_source, settings={}).network
    assert network is not None
    simulate = in_c(network) if target == "c" else in_python(network)
    with tempfile.TemporaryDirectory() as folder:
        for batch in range(BATCHES[target] + 1):
            path = Path(folder, f"recording{batch}.{name.rpartition('-')[2]}")
            without, recorded = seconds(network, simulate, None), seconds(network, simulate, path)
            if batch:
                report(recorded / without)


main(sys.argv[1], sys.argv[2])
