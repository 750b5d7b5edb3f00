"""Seconds of 1,000 runs of JIWY of 12.8 s in two native processes, or of compiling the program that makes them."""

from __future__ import annotations

import os
import sys
import tempfile
import time
from pathlib import Path

from timing import BATCHES, report, requested_benchmark

from cspdiag.base.sources import read_source
from cspdiag.simulate.native.build import CompilerError
from cspdiag.sweep.execute import Jobs, Pool, make_runs
from cspdiag.sweep.plan import Plan, Request, plan_sweep

JIWY = Path(__file__).parents[2] / "models/jiwy/jiwy.csp"
VALUES = {"panGains.kp": "1:4:40", "pan.inertia": "0.8e-3:1.2e-3:25"}
MEASURES = ("peak(control_horizontal)", "rms(pan.speed)")


def compiled(plan: Plan) -> Jobs:
    jobs = Jobs(plan, read_source, "c")
    try:
        _ = jobs[0]
    except CompilerError:
        sys.exit(0)
    return jobs


def main() -> None:
    request = Request(
        source=read_source(str(JIWY)), given=VALUES, measures=MEASURES, environment="Bench", until=12_800_000_000
    )
    plan = plan_sweep(request, read_source)
    if requested_benchmark() == "sweep-compile":
        with tempfile.TemporaryDirectory() as folder:
            os.environ["XDG_CACHE_HOME"] = folder
            report(compiled(plan).seconds)
        return
    jobs = compiled(plan)
    for _ in range(BATCHES):
        began = time.perf_counter()
        with Pool(2) as pool:
            count = sum(1 for _ in make_runs(plan, range(len(plan.grid)), jobs, pool))
        report(time.perf_counter() - began)
        assert count == 1000


main()
