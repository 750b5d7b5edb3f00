"""A simulation without a time limit ends on request, or when its parent ends."""

from __future__ import annotations

import os
import signal
import struct
import subprocess
import sys
from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.simulate.native.build import Build
from tests.c_kernel.building import need
from tests.conformance.sources import read

ENDLESS = """
process Pulse {
  in  slow : bool
  out beat : bool
  composition { (mu (wait 1 ms ; beat ! true)) || mu (after 1 ms -> skip []> after 1 ms -> skip) }
}
submodel Nobody { in beat : bool  out slow : bool  slow = false }
environment Bench for Pulse step 1 ms {
  nobody : Nobody
  beat        -> nobody.beat
  nobody.slow -> slow
}
"""

STOPPED = struct.pack("=II", 10, 4)
"""How the last record of the stream of a run that was stopped begins: its kind, and ``csp_ending``."""
LAST = 4 * 32
"""Its bytes: a row for itself and for each of its texts."""

PARENT = """
import os, subprocess, sys
lifeline, held = os.pipe()
subprocess.Popen([*sys.argv[1:], "--lifeline", str(lifeline)], pass_fds=[lifeline])
print("started", flush=True)
sys.stdin.read()
"""


@pytest.fixture(scope="module")
def simulation() -> Path:
    need("gcc")
    network = pipeline.build(SourceFile(name="pulse.csp", text=ENDLESS), read).network
    assert network is not None
    files = pipeline.generate(network, read, "c")
    sources = [
        path
        for path in files
        if path.endswith(".c") and ("csp_port_" not in path or path.endswith("csp_port_simulation.c"))
    ]
    return Build(files, sources, ("-O1", "-DCSP_TRACE=1")).executable()


@pytest.mark.parametrize(
    "number", ["SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGPIPE", "SIGALRM", "SIGUSR1", "SIGXCPU"]
)
def test_a_signal_ends_it(simulation: Path, number: str) -> None:
    sent = signal.Signals[number]
    with subprocess.Popen([simulation, "--observe", "ports"], stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        process.stdout.read(1)
        process.send_signal(sent)
        process.stdout.read()
    assert process.returncode == 128 + sent


def test_what_ends_it_for_its_parent_is_not_ignored(simulation: Path) -> None:
    """A parent that a script has started in the background passes ignored signals on to its children."""
    lifeline, held = os.pipe()
    command = ["sh", "-c", f"trap '' TERM INT; exec {simulation} --observe ports --lifeline {lifeline}"]
    with (
        os.fdopen(lifeline),
        os.fdopen(held, "w"),
        subprocess.Popen(command, stdout=subprocess.PIPE, pass_fds=[lifeline]) as process,
    ):
        assert process.stdout is not None
        process.stdout.read(1)
        process.send_signal(signal.SIGTERM)
        process.stdout.read()
    assert process.returncode == 128 + signal.SIGTERM


def test_two_signals_at_once_count_as_one(simulation: Path) -> None:
    """It reports how it ended, and its status is that of one of the signals, whichever was delivered first."""
    for _ in range(5):
        with subprocess.Popen([simulation, "--observe", "ports"], stdout=subprocess.PIPE) as process:
            assert process.stdout is not None
            process.stdout.read(1)
            process.send_signal(signal.SIGTERM)
            process.send_signal(signal.SIGINT)
            reported = process.stdout.read()
        assert process.returncode in (128 + signal.SIGTERM, 128 + signal.SIGINT)
        assert reported[-LAST:].startswith(STOPPED)


def test_a_native_run_ends_without_a_reader(simulation: Path) -> None:
    with subprocess.Popen([simulation, "--observe", "ports"], stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        process.stdout.read(1)
        process.stdout.close()
        assert process.wait(timeout=60) == 128 + signal.SIGPIPE


def test_it_ends_with_its_parent(simulation: Path) -> None:
    """When the parent ends, it closes the stream that the simulation writes to."""
    command = [sys.executable, "-c", PARENT, str(simulation)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as parent:
        assert parent.stdout is not None
        assert parent.stdout.readline() == b"started\n"
        parent.kill()
        parent.stdout.read()


def test_it_ends_with_its_lifeline_although_its_parent_lives(simulation: Path) -> None:
    lifeline, held = os.pipe()
    command = [simulation, "--observe", "ports", "--lifeline", str(lifeline)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, pass_fds=[lifeline]) as process:
        assert process.stdout is not None
        process.stdout.read(1)
        os.close(held)
        process.stdout.read()
    os.close(lifeline)
    assert process.returncode == 128 + signal.SIGTERM


def test_a_full_disk_ends_it(simulation: Path) -> None:
    with Path("/dev/full").open("wb") as full:
        done = subprocess.run([simulation, "--observe", "ports"], stdout=full, stderr=subprocess.PIPE, check=False)
    assert done.returncode == 1
    assert done.stderr.startswith(b"could not write everything to standard output")
