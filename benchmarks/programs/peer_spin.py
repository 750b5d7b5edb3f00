"""SPIN on the same philosophers: processes and rendezvous channels, as its users write them, or with ``states`` the
model that cspdiag exports.

Proofs take the time of SPIN, gcc and pan together; states per second of processor time are those of pan alone. Prints
nothing if SPIN is missing.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage
from tempfile import TemporaryDirectory

from philosophers import table
from timing import report, requested_benchmark, size_of

from cspdiag.codegen.promela.package import promela
from cspdiag.proofs.transitions.systems.system import INTERNAL, Component, System


def rendezvous(system: System) -> Iterator[str]:
    """The system with a channel for each event of two parties and a process for each component."""
    for number, event in enumerate(system.events):
        if len(event.parties) == 2:
            yield f"chan e{number} = [0] of {{ bit }};"
    for at, component in enumerate(system.components):
        yield from process(system, at, component)


def process(system: System, at: int, component: Component) -> Iterator[str]:
    yield f"active proctype p{at}() {{\n  goto s{component.initial};"
    for state, edges in enumerate(component.edges):
        ways = " ".join(f":: {guard(system, at, event)} -> goto s{after}" for event, after in edges)
        yield f"{'end' if state in component.terminal else 's'}{state}: if {ways or ':: false -> skip'} fi;".replace(
            f"end{state}:", f"s{state}: end{state}:"
        )
    yield "}"


def guard(system: System, at: int, event: int) -> str:
    if event == INTERNAL or len(system.events[event].parties) == 1:
        return "skip"
    return f"e{event}!0" if system.events[event].parties[0] == at else f"e{event}?0"


def processor() -> float:
    """The processor time, in seconds, of the programs run so far."""
    used = getrusage(RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run(folder: str, *command: str) -> str:
    return subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True).stdout


if shutil.which("spin") is None or shutil.which("gcc") is None:
    sys.exit()
system = table(size_of(requested_benchmark()))
exported = "exported" in sys.argv
with TemporaryDirectory() as folder:
    text = promela(system) if exported else "\n".join(rendezvous(system))
    Path(folder, "model.pml").write_text(text, encoding="utf-8")
    began = time.perf_counter()
    run(folder, "spin", "-a", "model.pml")
    run(folder, "gcc", "-O2", "-w", "-DSAFETY", *(["-DNOREDUCE"] if exported else []), "-o", "pan", "pan.c")
    used = processor()
    output = run(folder, "./pan", "-n", "-m2000000")
    ended = time.perf_counter()
    assert "errors: 0" in output
    stored = re.search(r"([0-9.e+]+) states, stored", output)
    assert stored is not None
    report(float(stored[1]) / (processor() - used) if "states" in requested_benchmark() else (ended - began) * 1e3)
