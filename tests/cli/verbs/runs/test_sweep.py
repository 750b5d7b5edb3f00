"""``cspdiag sweep``: the table, what is left after an interruption, and what it refuses."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
import zlib
from pathlib import Path

import pytest

from tests.cli.conftest import Command
from tests.sweep.programs import FATES, HEATER


@pytest.fixture
def heater(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "heater.csp"
    path.write_text(HEATER)
    return path


def test_the_table_is_on_standard_output_and_the_summary_on_standard_error(cspdiag: Command, tmp_path: Path) -> None:
    path = tmp_path / "fates.csp"
    path.write_text(FATES)
    result = cspdiag("sweep", path, "--set", "fate=0,4", "--measure", "max(answer)", "--workers", "1")
    assert result.code == 0
    assert [line.split() for line in result.out.splitlines()] == [
        ["run", "fate", "max(answer)", "ended", "time", "error"],
        ["0", "0", "7", "terminated", "1"],
        ["1", "4", "failed", "0.02", "Broken,", "in", "Fates", "(fates.csp:23)"],
    ]
    assert "2 runs in " in result.err
    assert result.err.rstrip().endswith("1 terminated, 1 failed")


def test_programs_that_have_to_be_built_are_announced(cspdiag: Command, heater: Path) -> None:
    result = cspdiag("sweep", heater, "--for", "1s", "--set", "T=0.2s,0.4s", "--set", "gain=1,2")
    assert result.code == 0
    assert "2 programs are built, one for each value of `T`: what can be a `parameter` needs one only" in result.err


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (["--set", "gains=1,2"], "there is no constant 'gains' (did you mean 'gain'?)"),
        (["--set", "gain=1:2:0"], "a sweep needs at least one"),
        (["--set", "gain=1<V>,2<V>"], "gain"),
        (["--set", "gain=1", "--set", "gain=2"], "gain is set twice"),
        (["--measure", "max(pressure)"], "there is no port or state 'pressure' to measure"),
        (["-o", "table.xls"], "the name must end in .csv or .parquet"),
        (["-o", "no/where.csv"], "there is no folder no"),
        (["--resume"], "--resume continues a sweep with -o FILE"),
        (["--workers", "0"], "expected a number of processes from 1 to 1024"),
        (["--environment", "Garden"], "Garden"),
    ],
)
def test_what_cannot_be_done_is_refused(cspdiag: Command, heater: Path, options: list[str], reason: str) -> None:
    result = cspdiag("sweep", heater, "--for", "1s", *options)
    assert result.code == 2
    assert reason in result.err
    assert result.out == ""


def test_runs_that_never_end_are_refused(cspdiag: Command, heater: Path) -> None:
    result = cspdiag("sweep", heater, "--set", "gain=1,2")
    assert result.code == 2
    assert "Thermostat never ends by itself: say when each run ends, such as --for 20s" in result.err


def test_a_program_with_errors(cspdiag: Command, heater: Path) -> None:
    heater.write_text(HEATER.replace("mu law", "mu lawn"))
    result = cspdiag("sweep", heater, "--for", "1s")
    assert result.code == 1
    assert "E0204" in result.err


def interrupted(heater: Path, how: signal.Signals) -> subprocess.CompletedProcess[bytes]:
    """A sweep of many runs that gets a signal when it has results."""
    command = [sys.executable, "-m", "cspdiag", "sweep", heater.name, "--for", "400s"]
    command += ["--set", "gain=0.1:1:3000", "--measure", "mean(power)", "-o", "table.csv"]
    with subprocess.Popen(command, cwd=heater.parent, stderr=subprocess.PIPE) as process:
        partial = heater.parent / "table.csv.partial"
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline and process.poll() is None:
            if partial.exists() and partial.read_text().count("\n") > 4:
                break
            time.sleep(0.01)
        os.kill(process.pid, how)
        _, errors = process.communicate(timeout=60)
    return subprocess.CompletedProcess(command, process.returncode, b"", errors)


def test_ctrl_c_leaves_what_can_be_resumed(cspdiag: Command, heater: Path) -> None:
    done = interrupted(heater, signal.SIGINT)
    assert done.returncode == 130
    assert b"of 3000 runs, which are in table.csv.partial; --resume makes the others" in done.stderr
    partial = heater.parent / "table.csv.partial"
    lines = partial.read_text().splitlines()
    assert not (heater.parent / "table.csv").exists()
    options = ("--for", "400s", "--set", "gain=0.1:1:3000", "--measure", "mean(power)", "-o", "table.csv")
    result = cspdiag("sweep", heater.name, *options)
    assert result.code == 2
    assert "has results of an interrupted sweep: --resume continues it; otherwise remove it" in result.err
    other = cspdiag("sweep", heater.name, "--for", "300s", *options[2:], "--resume")
    assert other.code == 2
    assert "belongs to another sweep" in other.err
    # The results that are there are not made again: one is changed to see it, and the last line is cut.
    number = lines[2].partition(",")[0]
    row = lines[2].rpartition(",")[0].replace("time limit", "terminated")
    changed = [*lines[:2], f"{row},{zlib.crc32(row.encode())}", *lines[3:-1], lines[-1][:5]]
    partial.write_text("\n".join(changed))
    assert cspdiag("sweep", heater.name, *options, "--resume", "--quiet").code == 0
    assert not partial.exists()
    rows = (heater.parent / "table.csv").read_text().splitlines()
    assert len(rows) == 3001
    assert [row.partition(",")[0] for row in rows[1:]] == [str(run) for run in range(3000)]
    assert sum("terminated" in row for row in rows) == 1
    assert rows[int(number) + 1].endswith("terminated,400.0,")


def test_sigkill_leaves_whole_lines_and_no_processes(heater: Path) -> None:
    done = interrupted(heater, signal.SIGKILL)
    assert done.returncode == -signal.SIGKILL
    mark, header, *rows = (heater.parent / "table.csv.partial").read_text().splitlines()
    assert mark.startswith("# cspdiag sweep ")
    assert header == "run,gain,mean(power),ended,time,error,checksum"
    assert len(rows) > 2
    assert all(row.count(",") == 6 for row in rows[:-1])


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no /dev/full")
def test_a_device_is_written_to_as_it_is(cspdiag: Command, heater: Path) -> None:
    (heater.parent / "table.csv").symlink_to("/dev/full")
    result = cspdiag("sweep", heater.name, "--for", "1s", "--set", "gain=1,2", "-o", "table.csv", "--workers", "1")
    assert result.code == 2
    assert "table.csv: no space left on device" in result.err
