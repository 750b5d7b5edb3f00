"""The cost of arrays of instances: entire commands on networks in which the number of instances is a constant.

``arrays.py arrays-check-1000 ring`` is one row of ``cspdiag bench``, in milliseconds. ``arrays.py table --count 10
--count 1000 --step check`` prints processor time and memory of each command on each network.
"""

from __future__ import annotations

import argparse
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from timing import BATCHES, report, requested_benchmark, size_of

NETWORKS = Path(__file__).parents[1] / "networks"
SIZES = {"ring": "size", "pipeline": "size", "workers": "size", "star": "size", "philosophers": "number"}
"""The constant that gives the number of instances of a network."""

STEPS = {
    "check": ("check",),
    "python": ("compile", "--force"),
    "python-O1": ("compile", "--force", "-O1"),
    "c": ("compile", "--force", "--target", "c"),
    "c-O1": ("compile", "--force", "--target", "c", "-O1"),
    "verify": ("verify", "--no-cache"),
}
COUNTS = (10, 100, 1_000, 10_000, 100_000)


class Cost(NamedTuple):
    """The cost of one command; ``status`` is its exit code, or the negative number of the signal that ended it."""

    wall: float
    processor: float
    memory: int
    """The maximum, in bytes."""
    status: int


def text_of(network: str, count: int) -> str:
    """The network with ``count`` instances; `check` takes no settings, so the constant itself is changed."""
    lines = (NETWORKS / f"{network}.csp").read_text(encoding="utf-8").splitlines()
    head = f"const {SIZES[network]} = "
    return "\n".join(f"{head}{count}" if line.startswith(head) else line for line in lines) + "\n"


def cost(step: str, network: str, count: int, limit: int) -> Cost:
    """The cost of one command, which is killed after ``limit`` seconds."""
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder, f"{network}.csp")
        program.write_text(text_of(network, count), encoding="utf-8")
        command = [sys.executable, "-m", "cspdiag", *STEPS[step], str(program)]
        if step not in ("check", "verify"):
            command += ["-o", f"{folder}/made"]
        if network == "philosophers" and step not in ("check", "verify"):
            command += ["--top", "Table"]
        began = time.perf_counter()
        running = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        signal.signal(signal.SIGALRM, lambda *_: running.kill())
        signal.alarm(limit)
        _, status, used = os.wait4(running.pid, 0)
        signal.alarm(0)
        running.returncode = os.waitstatus_to_exitcode(status)
        wall = time.perf_counter() - began
    return Cost(wall, used.ru_utime + used.ru_stime, used.ru_maxrss * 1024, running.returncode)


def table(arguments: Sequence[str]) -> None:
    """Print processor time and memory for all requested counts; a command that takes too long ends its row."""
    parser = argparse.ArgumentParser(prog="arrays.py table")
    parser.add_argument("--count", type=int, action="append", help="the number of instances; may be repeated")
    parser.add_argument("--network", choices=SIZES, action="append", help="only this one; may be repeated")
    parser.add_argument("--step", choices=STEPS, action="append", help="only this one; may be repeated")
    parser.add_argument("--limit", type=int, default=120, help="seconds that a command may take (default: 120)")
    given = parser.parse_args(arguments)
    counts = given.count or COUNTS
    print(f"{'':24}" + "".join(f"{count:>18,}" for count in counts))
    for step in given.step or STEPS:
        for network in given.network or SIZES:
            print(f"{step:10} {network:13}", end="", flush=True)
            for count in counts:
                taken = cost(step, network, count, given.limit)
                in_time = taken.status >= 0
                print(f"{_figures(taken) if in_time else f'> {given.limit} s':>18}", end="", flush=True)
                if not in_time:
                    break
            print(flush=True)


def _figures(taken: Cost) -> str:
    return f"{taken.processor:.2f} s {taken.memory / 1e6:5.0f} MB"


if __name__ == "__main__":
    if requested_benchmark() == "table":
        table(sys.argv[2:])
    else:
        name = requested_benchmark().split("-")[1]
        for _ in range(BATCHES if size_of(requested_benchmark()) <= 1_000 else 1):
            report(cost(name, sys.argv[2], size_of(requested_benchmark()), 110).wall * 1e3)
