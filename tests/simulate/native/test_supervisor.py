"""A native program ends when it should: after a signal, after it has reported its end, and with its parent."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

from cspdiag.runtime.kernel.stopping import stopping
from cspdiag.simulate.native.supervisor import Supervisor

ROOT = Path(__file__).parents[3]

needs_compiler = pytest.mark.skipif(not any(map(shutil.which, ("cc", "gcc", "clang"))), reason="there is no C compiler")

STUBBORN = ["sh", "-c", "trap '' INT TERM; exec sleep 60"]


def test_a_program_that_ignores_a_signal_is_killed() -> None:
    with stopping, subprocess.Popen(STUBBORN, start_new_session=True) as program, Supervisor(program) as supervisor:
        time.sleep(0.2)
        os.kill(os.getpid(), signal.SIGTERM)
        assert program.wait(timeout=20) == -signal.SIGKILL
    assert supervisor.killed
    assert str(supervisor.kill_error) == "the native program did not end within 2 s after SIGTERM, and was killed"


def test_a_program_that_has_reported_its_end_and_stays_is_killed() -> None:
    with (
        stopping,
        subprocess.Popen(["sleep", "60"], start_new_session=True) as program,
        Supervisor(program) as supervisor,
    ):
        supervisor.end_reported()
        assert program.wait(timeout=20) == -signal.SIGKILL
    assert (
        str(supervisor.kill_error)
        == "the native program did not end within 2 s after it had reported its end, and was killed"
    )


ENDLESS = """\
process Main { composition { (mu wait 1 ms) || (mu wait 1 ms) } }
environment Bench for Main { }
"""


STUCK = """\
submodel Law c "law.c" {
  in  x : double
  out y : double
}

process Main {
  in  x : double @ 10 ms
  out y : double @ 10 ms
  communication { law : Law x -> law.x law.y -> y }
  composition { mu law }
}

submodel World { out x : double in y : double x = 1 }
environment Bench for Main { world : World world.x -> x y -> world.y }
"""
LAW_HEADER = """\
#ifndef LAW_H
#define LAW_H
struct law { double x, y; };
void law_initialize(struct law *self);
void law_reset(struct law *self);
void law_calculate(struct law *self);
#endif
"""
LAW = """\
#include "law.h"
#include <stdio.h>
#include <unistd.h>
void law_initialize(struct law *self) { self->y = 0.0; }
void law_reset(struct law *self) { self->y = 0.0; }
void law_calculate(struct law *self)
{
    FILE *begun = fopen("begun", "w");
    (void)fclose(begun);
    for (;;) {
        (void)pause();
    }
}
"""


@needs_compiler
def test_a_step_that_hangs_is_left_by_a_signal(tmp_path: Path) -> None:
    for name, text in (("main.csp", STUCK), ("law.h", LAW_HEADER), ("law.c", LAW)):
        (tmp_path / name).write_text(text)
    command = [sys.executable, "-m", "cspdiag", "run", "main.csp", "--target", "c", "--record", "main.csv"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    with subprocess.Popen(command, cwd=tmp_path, env=environment, stderr=subprocess.PIPE, text=True) as parent:
        try:
            deadline = time.monotonic() + 60
            while not (tmp_path / "begun").exists() and parent.poll() is None and time.monotonic() < deadline:
                time.sleep(0.02)
            parent.terminate()
            _, reported = parent.communicate(timeout=20)
        finally:
            parent.kill()
    assert parent.returncode == 143, reported
    assert "Main in Bench: stopped by SIGTERM" in reported
    assert (tmp_path / "main.csv").exists()


def children(process: int) -> set[int]:
    found: set[int] = set()
    for task in Path(f"/proc/{process}/task").glob("*/children"):
        with suppress(OSError):
            found |= {int(number) for number in task.read_text().split()}
    return found


def is_native(process: int) -> bool:
    with suppress(OSError):
        return "--observe" in Path(f"/proc/{process}/cmdline").read_text()
    return False


def signals_are_for_the_main_thread(process: int) -> bool:
    """A signal sent to another thread does not wake the main one, which waits for what the native program reports."""
    masks = {
        int(status.parent.name): int(status.read_text().partition("SigBlk:")[2].split()[0], 16)
        for status in Path(f"/proc/{process}/task").glob("*/status")
    }
    return (
        masks.pop(process) == 0 and len(masks) > 0 and all(mask >> (signal.SIGTERM - 1) & 1 for mask in masks.values())
    )


@pytest.mark.skipif(sys.platform != "linux", reason="it looks at /proc")
@needs_compiler
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM, signal.SIGHUP])
def test_a_native_run_ends_with_its_parent(number: signal.Signals, tmp_path: Path) -> None:
    (tmp_path / "main.csp").write_text(ENDLESS)
    command = [sys.executable, "-m", "cspdiag", "run", "main.csp", "--target", "c", "--quiet"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    with subprocess.Popen(command, cwd=tmp_path, env=environment, stderr=subprocess.PIPE, text=True) as parent:
        try:
            native: list[int] = []
            deadline = time.monotonic() + 60
            while not native and parent.poll() is None and time.monotonic() < deadline:
                time.sleep(0.02)
                native = [child for child in children(parent.pid) if is_native(child)]
            assert native
            while not (is_ready := signals_are_for_the_main_thread(parent.pid)) and time.monotonic() < deadline:
                time.sleep(0.02)
            assert is_ready
            parent.send_signal(number)
            assert parent.wait(timeout=20) == (-number if number == signal.SIGKILL else 128 + number)
            while is_native(native[0]) and time.monotonic() < deadline:
                time.sleep(0.02)
            assert not is_native(native[0])
        finally:
            parent.kill()


@pytest.mark.skipif(sys.platform != "linux", reason="it looks at /proc")
@needs_compiler
def test_a_native_program_that_is_killed_leaves_no_recording_and_nothing_else(tmp_path: Path) -> None:
    (tmp_path / "main.csp").write_text(ENDLESS)
    (tmp_path / "temporary").mkdir()
    command = [sys.executable, "-m", "cspdiag", "run", "main.csp", "--target", "c", "--record", "main.npz"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "TMPDIR": str(tmp_path / "temporary")}
    with subprocess.Popen(command, cwd=tmp_path, env=environment, stderr=subprocess.PIPE, text=True) as parent:
        try:
            native: list[int] = []
            deadline = time.monotonic() + 60
            while not native and parent.poll() is None and time.monotonic() < deadline:
                time.sleep(0.02)
                native = [child for child in children(parent.pid) if is_native(child)]
            os.kill(native[0], signal.SIGKILL)
            _, reported = parent.communicate(timeout=20)
        finally:
            parent.kill()
    assert parent.returncode == 1, reported
    assert "the native program has failed" in reported
    assert "internal error" not in reported
    assert sorted(path.name for path in tmp_path.iterdir()) == ["main.csp", "temporary"]
    assert list((tmp_path / "temporary").iterdir()) == []
