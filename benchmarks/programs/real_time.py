"""Programs against the clock at 1 kHz on a loaded machine: ``real_time.py real-time-late python-O1``.

For each processor two processes compute all the time, except for a benchmark whose name ends with ``unloaded``.
``real-time-late`` prints the microseconds within which 99 % of the ticks were met,
``real-time-missed`` how many of 20 000 samples were missed.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from timing import report, requested_benchmark

from cspdiag import pipeline
from cspdiag.base.sources import read_source
from cspdiag.simulate.run.package import LoadedPackage

SECONDS = 5
TICKS = 1000 * SECONDS
PORTS = 2
NETWORKS = Path(__file__).parents[1] / "networks"
NETWORK = "closed_loop"


@contextmanager
def load() -> Iterator[None]:
    """Two busy processes for each processor, if the benchmark asks for them."""
    count = 0 if requested_benchmark().endswith("-unloaded") else 2 * (os.cpu_count() or 1)
    busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(count)]
    try:
        yield
    finally:
        for process in busy:
            process.kill()


def in_python(level: int) -> None:
    network = pipeline.build(read_source(str(NETWORKS / f"{NETWORK}.csp")), read_source).network
    assert network is not None
    package = LoadedPackage(network.name, pipeline.generate(network, read_source, "python", level))
    environment = package.module("environments").ENVIRONMENTS[network.environments[0].name]()
    running = package.module("network").build(environment.drivers)
    with load():
        outcome = running.run(environment=environment, until=SECONDS * 10**9, real_time=True, on_miss="count")
    (jitter,) = outcome.jitter.values()
    report_run(jitter.below(0.99) / 1e3, sum(outcome.missed.values()))


def in_c() -> None:
    """The kernel in C counts in classes that grow by powers of two: the end of one is an upper bound."""
    command = [sys.executable, "-m", "cspdiag", "run", "--real-time", "--target", "c", "--for", f"{SECONDS}s"]
    path = str(NETWORKS / f"{NETWORK}.csp")
    subprocess.run([*command[:-1], "1ms", path], check=True, capture_output=True)  # It is built.
    with load():
        done = subprocess.run([*command, path], check=False, capture_output=True, text=True)
    classes = re.findall(r"<\s+(\d+) us\s+(\d+)", done.stderr)
    missed = re.findall(r"angle_\w+ (\d+)", done.stdout)
    report_run(bound([(float(end), int(count)) for end, count in classes]), sum(map(int, missed)))


def by_cyclictest() -> None:
    """A thread that does nothing but wait, with the same priority: what the machine allows."""
    command = ["cyclictest", "--quiet", "--mlockall", "--priority=20", "--interval=1000", f"--loops={TICKS}"]
    if shutil.which("cyclictest") is None or "late" not in requested_benchmark():
        sys.exit(0)
    with load():
        done = subprocess.run([*command, "--histogram=20000"], check=False, capture_output=True, text=True)
    lines = re.findall(r"^(\d{6}) (\d+)$", done.stdout, re.MULTILINE)
    report_run(bound([(float(late), int(count)) for late, count in lines]), 0)


def bound(classes: Sequence[tuple[float, int]]) -> float:
    """The least lateness that 99 % of the ticks do not exceed."""
    most = 0.99 * sum(count for _, count in classes)
    number = 0
    for late, count in classes:
        number += count
        if number >= most:
            return late
    raise ValueError("no tick was counted")


def report_run(late: float, missed: int) -> None:
    report(late if "late" in requested_benchmark() else missed * 20_000 / (TICKS * PORTS))


match sys.argv[2]:
    case "c":
        in_c()
    case "cyclictest":
        by_cyclictest()
    case target:
        in_python(int(target[-1]))
