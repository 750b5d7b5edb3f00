"""A generated program with its own devices, against the clock of a POSIX system: events, slow devices, and every way in
which a run ends.

Nothing here depends on the speed of the machine.
"""

from __future__ import annotations

import re
import signal
import subprocess
import threading
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryFile
from typing import NamedTuple

import pytest

from cspdiag import pipeline
from tests.c_kernel.building import HERE, STRICT, need
from tests.conformance.sources import network_of, read
from tests.support.compiling import compile_once

DEVICES = HERE / "devices"
TERMINATED, FAILED, STOPPED, NOT_INITIALIZED = 0, 1, 4, 5
"""Numbers of ``csp_ending``."""


class Ended(NamedTuple):
    """How the machine ended, and what it printed."""

    status: int
    lines: Sequence[str]
    errors: str

    @property
    def releases(self) -> list[str]:
        """The safe values that were written, in order."""
        return [line for line in self.lines if line.startswith("released")]


BOTH = ["released drive -1", "released lamp 0"]


CRASHES = [getattr(signal, f"SIG{name}") for name in ("SEGV", "BUS", "FPE", "ILL", "ABRT", "TRAP", "SYS")]
HARMLESS = [getattr(signal, f"SIG{name}") for name in ("CHLD", "CONT", "URG", "WINCH", "TSTP", "TTIN", "TTOU")]
OF_ITS_OWN = [signal.SIGKILL, signal.SIGSTOP, signal.SIGUSR1]
STOPPING = sorted(signal.valid_signals() - {*CRASHES, *HARMLESS, *OF_ITS_OWN})


def built(folder: Path, program: Path, main: Path, *options: str) -> Path:
    """A program with the devices of a test, for POSIX."""
    for path, text in pipeline.generate(network_of(read(str(program))), read, "c").items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text)
    hosted = ("csp_port_", "csp_simulation", "csp_steering", "csp_stream", "csp_tuning", "main_")
    sources = [file for file in sorted(folder.rglob("*.c")) if not file.name.startswith(hosted)]
    flags = (*STRICT, "-O1", *options, "-DCSP_TRACE=0", f"-I{folder}", f"-I{folder / 'support'}")
    port = folder / "support" / "csp_port_posix.c"
    compile_once("gcc", *flags, *sources, port, main, "-lm", "-pthread", "-o", folder / "program")
    return folder / "program"


@pytest.fixture(scope="module")
def machine(tmp_path_factory: pytest.TempPathFactory) -> Path:
    need("gcc")
    return built(tmp_path_factory.mktemp("machine"), DEVICES / "machine.csp", DEVICES / "machine.c")


def ended(machine: Path, *arguments: str, signals: Sequence[int] = (), later: Sequence[int] = ()) -> Ended:
    """Run the machine; ``signals`` are sent to it while it drives, ``later`` while it lingers after its run."""
    sent = {"drives 5": signals, "lingers 1": later}
    lines: list[str] = []
    with (
        TemporaryFile("w+") as errors,
        subprocess.Popen([machine, *arguments], stdout=subprocess.PIPE, stderr=errors, text=True) as process,
    ):
        patience = threading.Timer(60, process.kill)
        patience.start()
        assert process.stdout is not None
        for line in process.stdout:
            lines.append(line.rstrip("\n"))
            for number in sent.pop(lines[-1], ()):
                process.send_signal(number)
        status = process.wait()
        patience.cancel()
        errors.seek(0)
        return Ended(status, lines, errors.read())


def test_an_event_input_of_an_own_device_is_polled(machine: Path) -> None:
    found = ended(machine, "polled")
    assert found.status == 0
    assert "polled 10" in found.lines
    assert "lamp 1" in found.lines
    assert f"ending {TERMINATED}" in found.lines


@pytest.mark.parametrize("by", ["a signal", "a thread"])
def test_an_event_is_delivered_from_outside(machine: Path, by: str) -> None:
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


@pytest.mark.parametrize("sent", STOPPING)
def test_signals_stop_the_run_with_safe_outputs(machine: Path, sent: int) -> None:
    found = ended(machine, "continues", signals=[sent])
    assert found.status == 128 + sent
    assert found.releases == BOTH
    assert f"ending {STOPPED}" in found.lines


@pytest.mark.parametrize("sent", CRASHES)
def test_signals_of_crashes_release_the_outputs(machine: Path, sent: int) -> None:
    found = ended(machine, "continues", signals=[sent])
    assert found.status == -sent
    assert found.releases == BOTH


@pytest.mark.parametrize("number", ["INT", "HUP", "TERM"])
def test_ignored_signals_stay_ignored(machine: Path, number: str) -> None:
    """As a shell starts a job in the background, and as ``nohup`` does."""
    script = machine.with_name(f"ignores_{number}")
    script.write_text(f"#!/bin/sh\ntrap '' {number}\nexec {machine} 'continues'\n")
    script.chmod(0o755)
    found = ended(script, signals=[signal.Signals[f"SIG{number}"], signal.SIGALRM])
    assert found.status == 128 + signal.SIGALRM
    assert found.releases == BOTH


def test_an_own_handler_is_respected(machine: Path) -> None:
    """SIGUSR1 is the button of the machine."""
    found = ended(machine, "pressed by a signal")
    assert found.status == 0
    assert f"ending {TERMINATED}" in found.lines


def test_a_signal_after_the_run_changes_nothing(machine: Path) -> None:
    found = ended(machine, "lingers", signals=[signal.SIGTERM], later=[signal.SIGINT])
    assert found.status == 128 + signal.SIGTERM


def test_child_processes_of_a_device_end_like_others(machine: Path) -> None:
    found = ended(machine, "children", signals=[signal.SIGTERM])
    assert found.status == 128 + signal.SIGTERM
    assert f"child ended by signal {int(signal.SIGTERM)}" in found.lines
    assert "child ended with 3" in found.lines
    assert found.releases == BOTH


@pytest.mark.parametrize(
    ("trouble", "status"), [("exits", 7), ("crashes", -signal.SIGSEGV), ("aborts", -signal.SIGABRT)]
)
def test_another_thread_that_ends_the_program_ends_the_run_before(machine: Path, trouble: str, status: int) -> None:
    """Nothing is written to an output after its safe value, even if the release takes time."""
    found = ended(machine, f"another thread {trouble}")
    assert found.status == status
    assert [line for line in found.lines if "drive" in line or "lamp" in line] == ["drives 5", *BOTH]


def test_another_thread_that_exits_does_not_wait_for_a_device_that_hangs(machine: Path) -> None:
    found = ended(machine, "another thread exits and read hangs")
    assert found.status == 7
    assert found.releases == BOTH


def test_a_run_whose_thread_ends_releases_the_outputs(machine: Path) -> None:
    found = ended(machine, "thread ends")
    assert found.status == 1
    assert found.releases == BOTH


def test_a_run_that_holds_signals_back_is_released_from_outside(machine: Path) -> None:
    found = ended(machine, "read hangs and signals are held back")
    assert found.status == 1
    assert found.releases == BOTH


@pytest.mark.parametrize("count", [2, 6])
def test_many_signals_count_as_one(machine: Path, count: int) -> None:
    found = ended(machine, "continues", signals=[signal.SIGINT, *[signal.SIGTERM] * (count - 1)])
    assert found.status in (128 + signal.SIGINT, 128 + signal.SIGTERM)
    assert found.releases == BOTH


@pytest.mark.parametrize(
    ("trouble", "says"),
    [
        ("read hangs", "the device function of Machine.level has not returned for 2 s: the outputs are released"),
        ("read spins", "the device function of Machine.level has not returned for 2 s: the outputs are released"),
        ("polled and safe value hangs", "Machine.drive does not take its safe value for 2 s"),
    ],
)
def test_a_device_that_hangs_is_detected_and_named(machine: Path, trouble: str, says: str) -> None:
    """A program that spins reads the time forever."""
    found = ended(machine, trouble)
    assert found.status == 1
    assert found.releases == BOTH
    assert says in found.errors


def test_a_control_law_that_hangs_is_named(tmp_path: Path) -> None:
    found = ended(built(tmp_path, DEVICES / "spinning.csp", DEVICES / "spinning.c"))
    assert found.status == 1
    assert found.lines == ["released"]
    assert "Spinning.law (spinning.csp:2) has not reached its next communication for 2 s" in found.errors


@pytest.mark.parametrize("hanging", ["read", "safe value"])
def test_a_device_that_hangs_keeps_no_output_driven(machine: Path, hanging: str) -> None:
    found = ended(machine, f"{hanging} hangs", signals=[signal.SIGTERM])
    assert found.status == 128 + signal.SIGTERM
    assert found.releases == BOTH


@pytest.mark.parametrize(
    ("trouble", "number"),
    [
        ("segmentation", signal.SIGSEGV),
        ("read overflows", signal.SIGSEGV),
        ("read overflows and safe value overflows", signal.SIGSEGV),
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


@pytest.mark.parametrize(("trouble", "status"), [("exit", 7), ("exit and safe value exits", 9)])
def test_a_device_that_exits_releases_the_outputs(machine: Path, trouble: str, status: int) -> None:
    found = ended(machine, trouble)
    assert found.status == status
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
    assert ended(machine, "critical").lines == ["masked in between 1", "masked after 0"]


def test_a_run_leaves_nothing_that_sanitizers_object_to(tmp_path: Path) -> None:
    """Exits of runs, too: a thread that is cancelled instead of joined leaves its stack poisoned."""
    need("gcc")
    checked = ("-O0", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    sanitized = built(tmp_path, DEVICES / "machine.csp", DEVICES / "machine.c", *checked)
    for trouble, status in (("polled", 0), ("critical", 0)):
        found = ended(sanitized, trouble)
        assert found.status == status, found.errors
        assert "Sanitizer" not in found.errors


def test_threads_share_nothing_unsynchronized(tmp_path: Path) -> None:
    need("gcc")
    sanitized = built(tmp_path, DEVICES / "machine.csp", DEVICES / "machine.c", "-g", "-fsanitize=thread")
    for trouble, status in (("pressed by a thread", 0), ("another thread exits", 7)):
        found = ended(sanitized, trouble)
        assert found.status == status, found.errors
        assert found.releases == BOTH
        assert "ThreadSanitizer" not in found.errors
