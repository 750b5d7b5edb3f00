"""The networks of ``benchmarks/networks``, compiled: ``networks.py commstime python-O1``.

Targets: ``python-O0``, ``python-O1``, ``c``; the last two keep the processes apart, and with the suffix ``-fused`` they
are fused if possible.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from timing import BATCHES, report

import cspdiag.codegen.c.package.package
import cspdiag.codegen.python.fast.package
from cspdiag import pipeline
from cspdiag.base.sources import read_source
from cspdiag.network.ir.network import CoreNetwork, Network
from cspdiag.optimize import PASSES, Pass, optimize
from cspdiag.simulate.run.package import LoadedPackage

NETWORKS = Path(__file__).parents[1] / "networks"
MODELS = Path(__file__).parents[2] / "models"
LONGER = {"python-O0": 1, "python-O1": 3, "python-O1-fused": 30, "c": 200, "c-fused": 2000}
"""How many times more iterations each target gets, so that each takes some tenths of a second."""


def network_of(name: str, settings: dict[str, int]) -> CoreNetwork:
    path = MODELS / "jiwy/jiwy.csp" if name == "jiwy" else NETWORKS / f"{name}.csp"
    texts = {key: str(value) for key, value in settings.items()}
    network = pipeline.build(read_source(str(path)), read_source, settings=texts).network
    assert network is not None
    return network


def without_fusion(network: Network, passes: Sequence[Pass] = PASSES) -> Network:
    return optimize(network, [entry for entry in passes if entry.name != "fuse"])


def run_in_python(network: CoreNetwork, level: int, until: int | None) -> Callable[[], float]:
    package = LoadedPackage(network.name, pipeline.generate(network, read_source, "python", level))
    build = package.module("network").build

    def run() -> float:
        environment = None
        if network.environments:
            environment = package.module("environments").ENVIRONMENTS[network.environments[0].name]()
        running = build(environment.drivers if environment is not None else {})
        began = time.perf_counter()
        outcome = running.run(environment=environment, until=until)
        taken = time.perf_counter() - began
        assert outcome.ended in ("terminated", "time limit"), outcome
        return taken

    return run


def built_in_c(network: CoreNetwork, folder: Path) -> Path:
    if shutil.which("cc") is None and shutil.which("gcc") is None:
        sys.exit(0)
    write(folder, pipeline.generate(network, read_source, "c", 1))
    subprocess.run(["make", "-s", "-C", str(folder)], check=True)
    return folder / f"{network.name}_simulation"


def run_in_c(network: CoreNetwork, folder: Path, until: int | None) -> Callable[[], float]:
    command = [str(built_in_c(network, folder)), *([] if until is None else ["--for", str(until)])]

    def run() -> float:
        output = subprocess.run(command, check=True, capture_output=True, text=True)
        taken = re.search(r" in (\S+) s", output.stdout + output.stderr)
        assert taken is not None, output
        return float(taken[1])

    return run


def write(folder: Path, files: dict[str, str]) -> None:
    for path, text in files.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text)


def runs_of(network: CoreNetwork, target: str, folder: Path, until: int | None = None) -> Callable[[], float]:
    if target.startswith("c"):
        return run_in_c(network, folder, until)
    return run_in_python(network, int(target[8]), until)


def memory(target: str, folder: Path) -> None:
    """Bytes per process: in C those of its static memory, in Python the growth of the resident memory."""
    size = 2_000 if target.startswith("c") else 10_000
    if target.startswith("c"):
        static = [static_memory(count, folder / str(count)) for count in (size, 2 * size)]
        report((static[1] - static[0]) / size)
        return
    write(
        folder / "memory",
        pipeline.generate(network_of("memory", {"size": size}), read_source, "python", int(target[8])),
    )
    script = Path(__file__).with_name("resident.py")
    subprocess.run([sys.executable, str(script), str(folder / "memory"), str(size)], check=True)


def static_memory(size: int, folder: Path) -> int:
    program = built_in_c(network_of("memory", {"size": size}), folder)
    text = subprocess.run(["size", str(program)], check=True, capture_output=True, text=True).stdout
    data, bss = re.findall(r"\d+", text.splitlines()[1])[1:3]
    return int(data) + int(bss)


def measure(name: str, target: str, folder: Path) -> None:
    longer = LONGER[target]
    rounds = 20_000 * longer
    match name.split("-"):
        case ["commstime"]:
            times(network_of("commstime", {"rounds": rounds}), target, folder, rounds * 4)
        case ["alternative", size]:
            times(network_of("alternative", {"rounds": rounds, "size": int(size)}), target, folder, rounds)
        case ["ring", *size]:
            length = int(size[0]) if size else 1000
            circles = max(1, rounds * 5 // length)
            times(network_of("ring", {"rounds": circles, "size": length}), target, folder, circles * length)
        case ["parallel"]:
            times(network_of("parallel", {"rounds": rounds}), target, folder, rounds)
        case ["delay"]:
            times(network_of("delay", {"rounds": rounds // 10}), target, folder, rounds)
        case ["memory"]:
            memory(target, folder)
        case ["closed", "loop"]:
            speed(network_of("closed_loop", {}), target, folder, 2_000_000_000 * longer)
        case ["jiwy"]:
            speed(network_of("jiwy", {}), target, folder, 12_780_000_000, limited=False)
        case _:
            sys.exit(f"unknown benchmark: {name}")


def times(network: CoreNetwork, target: str, folder: Path, communications: int) -> None:
    """Nanoseconds for each operation of the network."""
    run = runs_of(network, target, folder)
    run()
    for _ in range(BATCHES):
        report(run() / communications * 1e9)


def speed(network: CoreNetwork, target: str, folder: Path, until: int, *, limited: bool = True) -> None:
    """Simulated seconds per second."""
    run = runs_of(network, target, folder, until if limited else None)
    run()
    for _ in range(BATCHES):
        report(until / 1e9 / run())


def main(name: str, target: str) -> None:
    if not target.endswith("-fused"):
        cspdiag.codegen.c.package.package.optimize = without_fusion  # type: ignore[attr-defined, assignment]
        cspdiag.codegen.python.fast.package.optimize = without_fusion  # type: ignore[attr-defined, assignment]
    with tempfile.TemporaryDirectory() as folder:
        measure(name, target, Path(folder))


main(sys.argv[1], sys.argv[2])
