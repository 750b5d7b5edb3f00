"""However a program ends, each output is set to its safe value once, as its last value, every device is closed, and the
exit code says what happened.
"""

from __future__ import annotations

import os
import pty
import resource
import signal
import subprocess
import time
from pathlib import Path

import pytest

from tests.simulate.exits import WAYS, log_of, prepare, started, try_way, wait_until

TRIED = [
    ("SIGINT", "run -O1", "real time", True),
    ("SIGINT", "package -O0", "virtual time", False),
    ("SIGTERM", "package -O1", "real time", False),
    ("SIGTERM", "run -O0", "virtual time", False),
    ("SIGHUP", "package -O0", "real time", True),
    ("SIGQUIT", "package -O1", "virtual time", False),
    ("SIGPIPE is ignored", "package -O0", "real time", False),
    ("SIGUSR1", "package -O0", "virtual time", True),
    ("two signals", "package -O0", "real time", True),
    ("six signals", "package -O1", "virtual time", False),
    ("a signal during import", "package -O0", "virtual time", False),
    ("a signal during open", "package -O1", "real time", True),
    ("a signal while a read hangs", "package -O0", "virtual time", False),
    ("a read raises", "package -O1", "virtual time", False),
    ("a read exits", "package -O0", "real time", True),
    ("a read hangs", "package -O1", "real time", False),
    ("a write hangs", "package -O0", "real time", True),
    ("a read hangs for good", "package -O0", "real time", False),
    ("a write raises", "package -O0", "real time", True),
    ("a write exits", "package -O0", "virtual time", False),
    ("a text", "package -O1", "real time", True),
    ("nothing", "package -O0", "virtual time", False),
    ("a huge number", "package -O1", "virtual time", False),
    ("NaN", "package -O1", "real time", True),
    ("a body raises", "package -O0", "virtual time", False),
    ("a body exits", "package -O1", "real time", False),
    ("a safe write raises", "package -O0", "real time", True),
    ("a safe write hangs", "package -O1", "real time", True),
    ("a close raises", "package -O0", "virtual time", False),
    ("a safe write interrupts", "package -O1", "virtual time", False),
    ("a close interrupts", "package -O0", "real time", True),
    ("SIGTRAP", "package -O0", "virtual time", False),
    ("SIGSYS", "package -O1", "real time", True),
    ("a real-time signal", "package -O1", "real time", False),
    ("a signal while a body hangs", "package -O1", "virtual time", True),
    ("a signal while a body hangs for good", "package -O0", "virtual time", False),
    ("a driver restores the default", "package -O0", "virtual time", False),
    ("a handler raises", "run -O1", "real time", True),
    ("a handler exits", "package -O0", "virtual time", False),
    ("a child of a driver", "package -O1", "real time", False),
    ("a child comes back from open", "package -O0", "real time", True),
    ("a child comes back from a read", "package -O1", "real time", True),
    ("a child comes back from a read", "package -O1", "virtual time", False),
    ("a child comes back from a write", "package -O1", "real time", False),
    ("a child comes back from a write", "package -O0", "real time", True),
    ("a child comes back from a safe write", "package -O1", "virtual time", False),
    ("a child comes back from close", "package -O0", "virtual time", False),
    ("a child comes back from a body", "package -O1", "real time", False),
    ("a read interrupts", "package -O1", "virtual time", False),
    ("a read ends a generator", "package -O0", "real time", False),
    ("a read raises without a text", "package -O0", "real time", True),
    ("a write raises without a text", "package -O1", "virtual time", False),
    ("a constructor exits", "package -O1", "virtual time", False),
    ("a body interrupts", "package -O1", "virtual time", False),
    ("a body sets streams", "run -O1", "real time", False),
    ("a body sets streams", "package -O0", "virtual time", False),
    ("a body closes streams", "run -O1", "virtual time", False),
    ("a body closes streams", "package -O1", "real time", True),
    ("a body ends a generator", "package -O0", "real time", False),
    ("a body raises without a text", "package -O0", "virtual time", False),
    ("a body hangs for good", "package -O1", "real time", True),
    ("a program spins", "package -O1", "real time", False),
]
"""A selection of all combinations, in which each way to end and each way to start occurs."""

ONLY_HUNTED = {"a signal while a read hangs for good", "a body hangs"}
"""Combinations that take seconds and resemble others."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return prepare(tmp_path_factory.mktemp("ways out"))


@pytest.mark.parametrize(("name", "start", "clock", "blocking"), TRIED)
def test_outputs_are_released(folder: Path, name: str, start: str, clock: str, blocking: bool) -> None:
    way = next(way for way in WAYS if way.name == name)
    seen = try_way(folder, way, start, clock, blocking=blocking)
    assert seen.complaints(way) == [], seen


def test_every_exit_is_tried() -> None:
    assert {way.name for way in WAYS} == {name for name, *_ in TRIED} | ONLY_HUNTED


def released_once(own: Path) -> bool:
    calls = log_of(own)
    ends = [call for call in calls if call in ("valve -1", "light 7", "Card close", "Lamp close")]
    return ends == ["valve -1", "light 7", "Card close", "Lamp close"] and calls[-4:] == ends


def test_a_full_disk_costs_the_recording_and_not_the_release(folder: Path, tmp_path: Path) -> None:
    own = folder / "full"
    trace, record = tmp_path / "trace.jsonl", tmp_path / "record.csv"
    files = ["--for", "10s", "--trace", str(trace), "--record", str(record)]
    process = started(
        own, "run -O1", "virtual time", files=files,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (40_000, 40_000)),
    )  # fmt: skip
    text = process.communicate(timeout=30)[0].decode()
    assert process.returncode == 2
    assert f"cspdiag: {trace}: file too large\n" in text
    assert "reached the time limit at 10 s" in text
    assert f"wrote {record}\n" in text
    assert not trace.exists()
    assert record.exists()
    assert "Traceback" not in text
    assert released_once(own)


@pytest.mark.parametrize(("fault", "code"), [("", 1), ("read raises", 1)])
def test_a_summary_that_cannot_be_written_is_printed_elsewhere(folder: Path, fault: str, code: int) -> None:
    own = folder / f"account {fault}"
    with open("/dev/full", "w") as full:
        process = started(
            own, "package -O1", "virtual time", files=["--for", "1s"], fault=fault, stdout=full, stderr=subprocess.PIPE
        )
        text = process.communicate(timeout=30)[1].decode()
    assert process.returncode == code
    assert "Traceback" not in text
    assert fault or "the account of the run cannot be written: No space left on device\nreached the time limit" in text
    assert released_once(own)


def test_a_closed_pipe_for_the_summary_causes_no_traceback(folder: Path) -> None:
    own = folder / "reader"
    process = started(own, "package -O0", "virtual time", files=["--for", "1s"], stderr=subprocess.PIPE)
    assert process.stdout is not None
    process.stdout.close()
    assert process.stderr is not None
    assert process.stderr.read() == b""
    process.stderr.close()
    assert process.wait(timeout=30) == 141
    assert released_once(own)


@pytest.mark.parametrize("start", ["run -O1", "package -O1"])
def test_a_terminal_that_is_closed_ends_a_run(folder: Path, start: str) -> None:
    own = folder / f"terminal {start}"
    master, terminal = pty.openpty()

    def lead_session() -> None:
        import fcntl
        import termios

        os.setsid()
        fcntl.ioctl(0, termios.TIOCSCTTY, 0)

    process = started(
        own, start, "real time", stdin=terminal, stdout=terminal, stderr=terminal, preexec_fn=lead_session
    )
    os.close(terminal)
    wait_until(lambda: len(log_of(own)) > 6, process)
    os.close(master)
    assert process.wait(timeout=30) == 128 + signal.SIGHUP
    assert released_once(own)


def test_a_signal_that_was_to_be_ignored_is_ignored(folder: Path) -> None:
    own = folder / "ignored"
    process = started(own, "package -O0", "real time", preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
    wait_until(lambda: len(log_of(own)) > 4, process)
    process.send_signal(signal.SIGHUP)
    before = len(log_of(own))
    wait_until(lambda: len(log_of(own)) > before + 3, process)
    process.terminate()
    assert b"stopped by SIGTERM" in process.communicate(timeout=30)[0]
    assert process.returncode == 143


@pytest.mark.parametrize(
    ("fault", "start"), [("body leaves a thread", "run -O1"), ("body waits at exit", "package -O0")]
)
def test_threads_left_behind_keep_no_output_and_are_ended_by_a_signal(folder: Path, fault: str, start: str) -> None:
    own = folder / fault
    process = started(own, start, "virtual time", files=["--for", "1s"], fault=fault)
    wait_until(lambda: released_once(own), process)
    assert process.stdout is not None
    time.sleep(1.5)
    assert process.poll() is None
    process.terminate()
    assert b"time limit" in process.communicate(timeout=30)[0]
    assert process.returncode == 143
