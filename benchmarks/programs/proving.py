"""The time of a proof, in milliseconds; the network and its size are in the name of the benchmark.

Either of an entire process, or with ``started`` from the text to the answer in a process that has loaded what it needs.
"""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

from timing import BATCHES, report, requested_benchmark, size_of

from cspdiag.base.sources import read_source
from cspdiag.pipeline import build
from cspdiag.proofs.portfolio import prove_deadlock_free, prove_knot_free
from cspdiag.proofs.transitions import transition_system
from cspdiag.proofs.verdict import Limits, Proved

NETWORKS = {
    "philosophers": ("number", "Table"),
    "scheduler": ("number", "Scheduler"),
    "controller": ("joints", "Controller"),
    "butler": ("seats", "Table"),
}
"""The constant that gives the size of a network, and its outermost process."""

name = requested_benchmark().split("-")[1]
size, top = NETWORKS[name]
program = str(Path(__file__).parents[1] / "networks" / f"{name}.csp")


def whole_process() -> None:
    setting = f"{size}={size_of(requested_benchmark())}"
    command = [sys.executable, "-m", "cspdiag", "verify", "--no-cache", "--set", setting, program]
    subprocess.run(command, check=True, capture_output=True)


def started() -> None:
    built = build(read_source(program), read_source, top=top, settings={size: str(size_of(requested_benchmark()))})
    assert built.network is not None
    system = transition_system(built.network)
    assert isinstance(prove_deadlock_free(system, Limits()), Proved)
    assert isinstance(prove_knot_free(system, Limits()), Proved)


step = started if "started" in sys.argv else whole_process
step()
for _ in range(1 if size_of(requested_benchmark()) > 1000 else BATCHES):
    began = time.perf_counter()
    step()
    report((time.perf_counter() - began) * 1e3)
