"""A generated program with own devices, against the clock of a POSIX system: events, slow devices, and every way out of a run.

Nothing here depends on how fast the machine is.
"""

from __future__ import annotations

import re
import signal
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import pytest

from cspdiag import pipeline
from tests.c_kernel.building import HERE, STRICT, SUPPORT, need, run
from tests.conformance.sources import network_of, read

DEVICES = HERE / "devices"
TERMINATED, FAILED, STOPPED, NOT_INITIALIZED = 0, 1, 4, 5
"""Numbers of ``csp_ending``."""


class Ended(NamedTuple):
    """How the machine came to its end, and what it said."""

    status: int
    lines: Sequence[str]
    errors: str

    @property
    def releases(self) -> list[str]:
        """The safe values that were handed over, in order."""
        return [line for line in self.lines if line.startswith("released")]


BOTH = ["released drive -1", "released lamp 0"]


@pytest.fixture(scope="module")
def machine(tmp_path_factory: pytest.TempPathFactory) -> Path:
    need("gcc")
    folder = tmp_path_factory.mktemp("machine")
    for path, text in pipeline.generate(network_of(read(str(DEVICES / "machine.csp"))), read, "c").items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text)
    hosted = ("csp_port_", "csp_simulation", "csp_stream", "main_")
    sources = [file for file in sorted(folder.rglob("*.c")) if not file.name.startswith(hosted)]
    flags = (*STRICT, "-O1", "-DCSP_TRACE=0", f"-I{folder}", f"-I{folder / 'support'}")
    port = SUPPORT / "csp_port_posix.c"
    run("gcc", *flags, *sources, port, DEVICES / "machine.c", "-lm", "-pthread", "-o", folder / "machine")
    return folder / "machine"


def ended(machine: Path, *arguments: str, signals: Sequence[signal.Signals] = ()) -> Ended:
    """Runs the machine; ``signals`` are sent to it when it drives."""
    with subprocess.Popen([machine, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        lines: list[str] = []
        if signals:
            for line in process.stdout:
                lines.append(line)
                if line.startswith("drives"):
                    break
            for number in signals:
                process.send_signal(number)
        try:
            rest, errors = process.communicate(timeout=60)
        except subprocess.TimeoutExpired:
            process.kill()
            raise
    return Ended(process.returncode, [line.rstrip("\n") for line in (*lines, *rest.splitlines())], errors)


def test_an_event_input_of_an_own_device_is_polled(machine: Path) -> None:
    found = ended(machine, "polled")
    assert found.status == 0
    assert "polled 10" in found.lines
    assert "lamp 1" in found.lines
    assert f"ending {TERMINATED}" in found.lines


@pytest.mark.parametrize("by", ["a signal", "a thread"])
def test_an_event_is_brought_from_outside(machine: Path, by: str) -> None:
    found = ended(machine, f"pressed by {by}")
    assert found.status == 0
    assert "polled 0" in found.lines
    assert "lamp 1" in found.lines
    assert found.releases == BOTH


def test_a_device_slower_than_its_period_misses_samples(machine: Path) -> None:
    found = ended(machine, "slow")
    assert found.status == 1
    assert f"ending {FAILED}" in found.lines
    assert any(line.startswith("Timeout: a sample of") for line in found.lines), found.lines
    assert found.releases == BOTH


def test_missed_samples_are_counted(machine: Path) -> None:
    (counts,) = [line for line in ended(machine, "slow").errors.splitlines() if "missed samples" in line]
    assert re.search(r"Machine\.level [1-9]", counts)
    (counts,) = [line for line in ended(machine, "polled").errors.splitlines() if "missed samples" in line]
    assert counts.startswith("  missed samples: ")


@pytest.mark.parametrize("number", ["SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGPIPE"])
def test_signals_stop_the_run_with_safe_outputs(machine: Path, number: str) -> None:
    sent = signal.Signals[number]
    found = ended(machine, "goes on", signals=[sent])
    assert found.status == 128 + sent
    assert found.releases == BOTH
    assert f"ending {STOPPED}" in found.lines


@pytest.mark.parametrize("count", [2, 6])
def test_many_signals_are_as_one(machine: Path, count: int) -> None:
    found = ended(machine, "goes on", signals=[signal.SIGINT, *[signal.SIGTERM] * (count - 1)])
    assert found.status in (128 + signal.SIGINT, 128 + signal.SIGTERM)
    assert found.releases == BOTH


def test_a_device_that_hangs_keeps_no_output_driven(machine: Path) -> None:
    found = ended(machine, "read hangs", signals=[signal.SIGTERM])
    assert found.status == 128 + signal.SIGTERM
    assert found.releases == BOTH


def test_a_device_that_hangs_is_noticed_without_a_signal(machine: Path) -> None:
    found = ended(machine, "read hangs")
    assert found.status == 1
    assert found.releases == BOTH
    assert "has not come back" in found.errors


def test_a_safe_value_that_hangs_keeps_no_other_output_driven(machine: Path) -> None:
    found = ended(machine, "safe value hangs", signals=[signal.SIGTERM])
    assert found.status == 128 + signal.SIGTERM
    assert found.releases == BOTH


@pytest.mark.parametrize(
    ("trouble", "number"),
    [
        ("segmentation", signal.SIGSEGV),
        ("overflow", signal.SIGSEGV),
        ("division", signal.SIGFPE),
        ("abort", signal.SIGABRT),
    ],
)
def test_a_crash_releases_the_outputs(machine: Path, trouble: str, number: int) -> None:
    found = ended(machine, trouble)
    assert found.status == -number
    assert found.releases == BOTH


def test_a_safe_value_that_crashes_keeps_no_other_output_driven(machine: Path) -> None:
    found = ended(machine, "safe value crashes", signals=[signal.SIGTERM])
    assert found.status == -signal.SIGSEGV
    assert found.releases == BOTH


def test_a_device_that_exits_releases_the_outputs(machine: Path) -> None:
    found = ended(machine, "exit")
    assert found.status == 7
    assert found.releases == BOTH


def test_a_network_that_is_built_again_runs_again(machine: Path) -> None:
    found = ended(machine, "polled", "built")
    assert found.status == 0
    assert found.lines.count("polled 10") == 2
    assert found.lines.count("lamp 1") == 2
    assert found.releases == BOTH * 2


def test_a_network_that_is_not_built_again_is_refused(machine: Path) -> None:
    found = ended(machine, "polled", "as it is")
    assert found.status == 1
    assert found.lines[-2] == f"ending {NOT_INITIALIZED}"
    assert found.releases == BOTH


def test_the_hook_is_called_in_each_turn(machine: Path) -> None:
    assert ended(machine, "polled").lines[-1] == "alive 1"


def test_critical_sections_nest(machine: Path) -> None:
    assert ended(machine, "critical").lines == ["masked in between 1", "masked behind 0"]
