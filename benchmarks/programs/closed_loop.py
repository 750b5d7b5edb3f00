"""JIWY's generated controller against its plant."""

from __future__ import annotations

import time
from pathlib import Path

from timing import BATCHES, report

from cspdiag.codegen.python import generate
from cspdiag.pipeline import build
from cspdiag.simulate.package import LoadedPackage
from cspdiag.sources import read_source

network = build(read_source(str(Path(__file__).parents[2] / "models/jiwy/jiwy.csp")), read_source).network
assert network is not None
package = LoadedPackage(network.name, generate(network))
for _ in range(BATCHES):
    environment = package.module("environments").ENVIRONMENTS["Bench"]()
    program = package.module("network").build(environment.drivers)
    began = time.perf_counter()
    outcome = program.run(environment=environment)
    assert outcome.ended == "terminated", outcome
    report(outcome.time / 1e9 / (time.perf_counter() - began))
