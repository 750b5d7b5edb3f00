"""The kernel against the clock of a POSIX system. Nothing here depends on the speed of the machine."""

from __future__ import annotations

import signal
import subprocess
from pathlib import Path

import pytest

from tests.c_kernel.building import HERE, SCENARIOS, STRICT, SUPPORT, kernel_files, need, run
from tests.support.compiling import compile_once


@pytest.fixture(scope="module")
def objects(tmp_path_factory: pytest.TempPathFactory) -> Path:
    need("gcc")
    folder = tmp_path_factory.mktemp("posix")
    compile_once(
        "gcc", *STRICT, *SCENARIOS, f"-I{SUPPORT}", "-c", *kernel_files("posix"), HERE / "script.c", cwd=folder
    )
    return folder


def built(objects: Path, program: Path) -> Path:
    executable = objects / program.stem
    includes = (f"-I{SUPPORT}", f"-I{HERE}")
    compile_once("gcc", *STRICT, *SCENARIOS, *includes, program, *objects.glob("*.o"), "-lm", "-o", executable)
    return executable


def test_the_same_trace_as_in_virtual_time(objects: Path) -> None:
    program = HERE / "programs" / "rendezvous.c"
    assert run(built(objects, program)) == program.with_suffix(".txt").read_text()


def test_a_signal_ends_the_run_and_releases_the_outputs(objects: Path) -> None:
    executable = built(objects, HERE / "real_time" / "endless.c")
    with subprocess.Popen([executable], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        next(line for line in process.stdout if "drive 3" in line)
        process.send_signal(signal.SIGUSR1)
        next(line for line in process.stdout if "listener: pressed 1" in line)
        process.send_signal(signal.SIGTERM)
        *_, released, ended = process.stdout.read().splitlines()
        late = process.stderr.read()
    assert released.endswith("release drive -1")
    assert ended.endswith("stopped")
    assert "instants, late by" in late
