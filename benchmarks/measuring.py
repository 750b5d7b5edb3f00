"""What is measured, and how: each sample in a process of its own, the contestants in turn, so that a busy machine
affects all of them alike.

A program in ``programs/`` takes the name of a benchmark and prints one number per line, or nothing if something that it
needs is missing.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from statistics import median

PROGRAMS = Path(__file__).resolve().parent / "programs"
OURS = ("-O0", "-O1", "C", "cspdiag")
"""Readable Python, optimized Python, C, and the tool itself: peers are compared with each of them."""


@dataclass(frozen=True)
class Benchmark:
    """``less`` says whether a smaller figure is better; ``contestants`` are commands by the names that users see."""

    name: str
    about: str
    unit: str
    contestants: dict[str, str]
    goal: str = ""
    less: bool = True


_TARGETS = {"-O0": "networks python-O0", "-O1": "networks python-O1", "C": "networks c"}
_FUSED = {"-O1 fused": "networks python-O1-fused", "C fused": "networks c-fused"}
_PEERS = {name: f"peer_{name.lower()}" for name in ("asyncio", "trio", "simpy", "PyCSP", "Go")}
_ALTERNATING = {name: _PEERS[name] for name in ("asyncio", "PyCSP", "Go")}
_RECORD = {"-O1": "recording python", "C": "recording c"}
_AGAINST_THE_CLOCK = {"-O0": "real_time python-O0", "-O1": "real_time python-O1", "C": "real_time c"}
_CHECK = {"cspdiag": "checking"}
_EDIT = {"cspdiag": "editing"}
_PROVE = {"cspdiag": "proving"}
_RESPOND = {"cspdiag": "responding"}
_ARRAYS = {name: f"arrays {name}" for name in ("ring", "pipeline", "workers", "star", "philosophers")}

BENCHMARKS = (
    Benchmark(
        "commstime", "a communication in a ring of four processes", "ns", _TARGETS | _FUSED | _PEERS,
        "-O0 300 ns: asyncio 9 times, PyCSP 4; -O1 70 ns: asyncio 38, PyCSP 18, trio 75, faster than Go; fused 10 ns; "
        "C 4 ns: Go 25 times",
    ),
    Benchmark(
        "alternative-10", "a choice among 10 writers", "ns", _TARGETS | _ALTERNATING,
        "-O1 220 ns, C 5 ns, and no more for 1000 writers",
    ),
    Benchmark("alternative-100", "a choice among 100 writers", "ns", _TARGETS | _ALTERNATING),
    Benchmark("alternative-1000", "a choice among 1000 writers", "ns", _TARGETS),
    Benchmark("ring", "a hop in a ring of 1000 processes", "ns", _TARGETS | _PEERS),
    Benchmark("ring-100000", "a hop in a ring of 100 000 processes", "ns", {"C": "networks c", "Go": "peer_go"}),
    Benchmark("parallel", "a parallel of two that add one", "ns", _TARGETS | _PEERS),
    Benchmark(
        "memory", "a waiting process with its channel", "bytes", _TARGETS | _PEERS, "-O1 650 bytes, C 100 bytes",
    ),
    Benchmark("delay", "a delay in virtual time, ten processes", "ns", _TARGETS | {"simpy": "peer_simpy"}),
    Benchmark(
        "closed-loop", "two motors with PID at 1 kHz: simulated seconds per second", "", _TARGETS | _FUSED,
        "-O1 450, C 15 000", less=False,
    ),
    Benchmark(
        "jiwy", "JIWY against its plant: simulated seconds per second", "", _TARGETS,
        "-O0 40, -O1 100, C 3000", less=False,
    ),
    Benchmark(
        "recording-npz", "JIWY recorded in an archive against JIWY not recorded", "times", _RECORD,
        "C 1.7 times, Python 1.15",
    ),
    Benchmark(
        "recording-csv", "the same in a table, which is bound by writing floating-point numbers as text", "times",
        _RECORD,
    ),
    Benchmark(
        "recording-mcap", "JIWY recorded while it runs, as MCAP, against JIWY not recorded", "times", _RECORD,
        "Python 1.1 times, C 1.3",
    ),
    Benchmark(
        "fmu-step", "a millisecond of JIWY, or a step of a Reference FMU", "us",
        {
            "native": "fmus native", "C, plant FMU": "fmus c", "-O1, plant FMU": "fmus python", "fmpy": "fmus fmpy",
        },
        "C, plant FMU: native 2 times",
    ),
    Benchmark(
        "sweep-1000", "1,000 runs of JIWY of 12.8 s in two native processes", "s", {"C": "sweeping"}, "at most 3 s",
    ),
    Benchmark("sweep-compile", "compiling the program that makes them", "s", {"C": "sweeping"}),
    Benchmark("device-udp", "a round trip through a program in Python by UDP", "us", {"-O1": "devices"}),
    Benchmark("device-serial", "the same by a pseudo-terminal", "us", {"-O1": "devices"}),
    Benchmark("device-can", "the same by a CAN bus that is made of multicast", "us", {"-O1": "devices"}),
    Benchmark(
        "real-time-late", "two processes for each processor besides: 99 % of the ticks at 1 kHz are met within", "us",
        _AGAINST_THE_CLOCK | {"cyclictest": "real_time cyclictest"}, "Python 1000 us",
    ),
    Benchmark(
        "real-time-late-unloaded", "the same without the other processes", "us",
        _AGAINST_THE_CLOCK | {"cyclictest": "real_time cyclictest"},
    ),
    Benchmark("real-time-missed", "the same: samples missed of 20 000", "", _AGAINST_THE_CLOCK, "a third of 653"),
    Benchmark("check-cold", "a cold `cspdiag check` of JIWY", "ms", {"cspdiag": "cold_start"}, "at most 100 ms"),
    Benchmark(
        "check-server", "`cspdiag check --server` of JIWY, whose server has learned it", "ms",
        {"cspdiag": "cold_start server"}, "at most 40 ms",
    ),
    Benchmark(
        "check-server-changed", "the same after a change of its main file", "ms",
        {"cspdiag": "cold_start server changed"},
    ),
    Benchmark(
        "edit-2000", "from a keystroke in 2,000 lines to the diagnostics of the language server", "ms", _EDIT,
        "at most 60 ms",
    ),
    Benchmark("edit-memory-10000", "what 10,000 keystrokes add to the memory of the language server", "kB", _EDIT),
    Benchmark("check-1000", "checking 1000 lines of instances", "ms", _CHECK),
    Benchmark("check-10000", "checking 10 000 lines of instances", "ms", _CHECK, "at most 2500 ms"),
    Benchmark("compile-1000", "compiling 1000 lines of instances to Python", "ms", _CHECK),
    Benchmark("arrays-check-1000", "a whole `check` of arrays of 1000 instances", "ms", _ARRAYS),
    Benchmark("arrays-check-100000", "the same for 100 000 instances", "ms", _ARRAYS, "ten times that of 10 000"),
    Benchmark("arrays-python-1000", "compiling them to Python", "ms", _ARRAYS),
    Benchmark("arrays-c-1000", "compiling them to C", "ms", _ARRAYS),
    Benchmark("arrays-verify-1000", "verifying them", "ms", _ARRAYS),
    Benchmark(
        "prove-philosophers-8", "a proof that 8 philosophers have no deadlock and no knot, from the text", "ms",
        {"cspdiag": "proving started", "whole": "proving", "SPIN": "peer_spin"}, "SPIN, with gcc and pan, 20 times",
    ),
    Benchmark(
        "prove-philosophers-1000", "the same for 1000 philosophers, in a new process", "ms", _PROVE,
        "at most 1000 ms",
    ),
    Benchmark("prove-philosophers-10000", "the same for 10 000 philosophers", "ms", _PROVE, "at most 10 000 ms"),
    Benchmark(
        "prove-scheduler-1000", "the same for Milner's scheduler with 1000 cells", "ms", _PROVE, "at most 1000 ms",
    ),
    Benchmark("prove-scheduler-10000", "the same with 10 000 cells", "ms", _PROVE, "at most 10 000 ms"),
    Benchmark(
        "prove-controller-4", "the same for a controller of 4 joints (SPIN: no answer in 200 s)", "ms", _PROVE,
        "at most 1000 ms",
    ),
    Benchmark(
        "prove-butler-20", "the same for 20 philosophers and a butler who counts them", "ms", _PROVE, "at most 2000 ms",
    ),
    Benchmark("prove-butler-60", "the same for 60 of them", "ms", _PROVE, "at most 10 000 ms"),
    Benchmark("respond-100", "response times of 100 tasks, each with its own level", "ms", _RESPOND, "at most 50 ms"),
    Benchmark(
        "respond-levels-100", "the same with five levels, first come, first served", "ms", _RESPOND, "at most 50 ms",
    ),
    Benchmark(
        "search-states-8", "states per second of processor time, breadth-first, 8 philosophers", "/s",
        {"cspdiag": "searching", "SPIN": "peer_spin", "SPIN, our export": "peer_spin exported"},
        "SPIN 5 times", less=False,
    ),
)  # fmt: skip


def main(arguments: Sequence[str]) -> int:
    """Run the benchmarks; returns 0, or 2 for a wrong option (from argparse)."""
    parser = argparse.ArgumentParser(
        prog="python benchmarks", epilog="example: python benchmarks --only commstime --rounds 7"
    )
    add_arguments(parser)
    return run(parser.parse_args(arguments))


def run(given: argparse.Namespace) -> int:
    """Run the benchmarks that were chosen; returns 0, or 1 if the program of a contestant failed."""
    chosen = [benchmark for benchmark in BENCHMARKS if not given.only or benchmark.name in given.only]
    samples: dict[str, dict[str, list[float]]] = {}
    failed = False
    for benchmark in chosen:
        measured = measure(benchmark, given.rounds)
        for line in rows(benchmark, measured):
            print(line, flush=True)
        samples[benchmark.name] = {name: values for name, values in measured.items() if values}
        failed |= None in measured.values()
    if given.json is not None:
        Path(given.json).write_text(json.dumps(results(chosen, samples), indent=2) + "\n")
    return int(failed)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "--only", action="append", type=_name, metavar="NAME",
        help="only this one; may be repeated: " + ", ".join(benchmark.name for benchmark in BENCHMARKS),
    )  # fmt: skip
    parser.add_argument("--rounds", type=_count, default=3, metavar="N", help="how often each is run (default: 3)")
    parser.add_argument("--json", metavar="FILE", help="also write all samples and medians to FILE")


def _name(text: str) -> str:
    names = [benchmark.name for benchmark in BENCHMARKS]
    if text not in names:
        near = get_close_matches(text, names, n=1)
        known = f"did you mean {near[0]}?" if near else f"there are: {', '.join(names)}"
        raise argparse.ArgumentTypeError(f"there is no benchmark {text!r}: {known}")
    return text


def _count(text: str) -> int:
    if not (text.isascii() and text.isdecimal()) or len(text) > 9 or int(text) < 1:
        raise argparse.ArgumentTypeError(f"expected a positive number, not {text!r}")
    return int(text)


def measure(benchmark: Benchmark, rounds: int) -> dict[str, list[float] | None]:
    """All samples of a benchmark by contestant: none where something that it needs is missing, and None where its
    program failed, which then is not run again.
    """
    samples: dict[str, list[float] | None] = {name: [] for name in benchmark.contestants}
    for _ in range(rounds):
        for name, program in benchmark.contestants.items():
            before = samples[name]
            if before is not None:
                figures = run_program(program, benchmark.name)
                samples[name] = None if figures is None else before + figures
    return samples


def run_program(program: str, benchmark: str) -> list[float] | None:
    """The figures that one run of a program prints, None if it failed; ``program`` is its name, with arguments that
    follow the name of the benchmark.
    """
    program, *given = program.split()
    root = str(PROGRAMS.parents[1])
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([root, os.environ.get("PYTHONPATH", "")])}
    command = [sys.executable, str(PROGRAMS / f"{program}.py"), benchmark, *given]
    try:
        done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120, check=False)
    except subprocess.TimeoutExpired:
        print(f"  {program} {benchmark}: no answer within 120 s", file=sys.stderr)
        return None
    if done.returncode:
        reason = "".join(done.stderr.strip().splitlines()[-1:]) or f"exit code {done.returncode}"
        print(f"  {program} {benchmark}: {reason}", file=sys.stderr)
        return None
    return [float(line) for line in done.stdout.split()]


def rows(benchmark: Benchmark, measured: dict[str, list[float] | None]) -> Iterator[str]:
    """The part of the table for one benchmark: medians, and how many times better cspdiag's are than the others."""
    yield f"{benchmark.name}: {benchmark.about}" + (f" (goal: {benchmark.goal})" if benchmark.goal else "")
    samples = {name: values for name, values in measured.items() if values}
    ours = {name: median(samples[name]) for name in OURS if name in samples}
    for name, values in samples.items():
        figure = median(values)
        ratios = [] if "-O" in name or name.startswith("C") or name in ours else _ratios(benchmark, figure, ours)
        yield f"  {name:10} {figure:12,.4g} {benchmark.unit:6}{''.join(ratios)}".rstrip()
    for name in measured.keys() - samples.keys():
        yield f"  {name:10} {'failed' if measured[name] is None else 'not here':>12}"


def _ratios(benchmark: Benchmark, figure: float, ours: dict[str, float]) -> list[str]:
    return [
        f"{_times(benchmark, figure, reference):10.1f} times {name}" for name, reference in ours.items() if reference
    ]


def _times(benchmark: Benchmark, figure: float, reference: float) -> float:
    return figure / reference if benchmark.less else reference / figure


def results(chosen: Sequence[Benchmark], samples: dict[str, dict[str, list[float]]]) -> list[dict[str, object]]:
    """The contents of the JSON file: an object for each benchmark and contestant."""
    return [
        {
            "benchmark": benchmark.name,
            "unit": benchmark.unit,
            "contestant": name,
            "median": median(values),
            "samples": values,
        }
        for benchmark in chosen
        for name, values in samples[benchmark.name].items()
    ]
