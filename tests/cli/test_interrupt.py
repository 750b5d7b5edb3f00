"""Ctrl-C ends a command, whatever it is doing, with exit 130 and without a traceback."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from cspdiag.cli.main import main

ROOT = Path(__file__).parents[2]

DRIVEN = """\
driver Lamp python "lamp.py:Lamp" { in light : int }

process Blink {
  out light : int @ 10 ms
  communication { var n : int = 0 }
  composition { mu (n := n + 1 ; light ! n ; wait 10 ms) }
}

environment Bench for Blink {
  lamp : Lamp
  light -> lamp.light
}
"""

LAMP = """\
from pathlib import Path


class Lamp:
    def open(self):
        Path("opened").touch()

    def write(self, port, value):
        Path("last").write_text(str(value))

    def close(self):
        Path("closed").touch()
"""


def start(folder: Path, *arguments: str) -> subprocess.Popen[str]:
    return start_python(folder, "cspdiag", *arguments)


def start_python(folder: Path, *arguments: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", *arguments],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def interrupt(process: subprocess.Popen[str]) -> tuple[int, str, str]:
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=20)
    return process.returncode, out, err


def wait_for(path: Path, process: subprocess.Popen[str]) -> None:
    deadline = time.monotonic() + 60
    while not path.exists():
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < deadline, f"{path} does not appear"
        time.sleep(0.02)


def test_while_it_waits_for_standard_input(tmp_path: Path) -> None:
    process = start(tmp_path, "check", "-")
    time.sleep(1)
    assert interrupt(process) == (130, "", "")


@pytest.mark.parametrize("options", [[], ["--real-time"]], ids=["virtual time", "real time"])
def test_a_run_releases_its_outputs_and_closes_its_recordings(tmp_path: Path, options: list[str]) -> None:
    (tmp_path / "blink.csp").write_text(DRIVEN)
    (tmp_path / "lamp.py").write_text(LAMP)
    process = start(tmp_path, "run", "blink.csp", "--record", "blink.csv", "--trace", "blink.jsonl", *options)
    wait_for(tmp_path / "last", process)
    time.sleep(0.3)
    code, out, err = interrupt(process)
    assert code == 130
    assert "Traceback" not in out + err
    assert "stopped by SIGINT" in out + err
    assert (tmp_path / "closed").exists()
    assert (tmp_path / "last").read_text() == "0"
    assert (tmp_path / "blink.csv").read_text().startswith("time,light\n")
    assert (tmp_path / "blink.jsonl").read_text().endswith("}\n")


SLOW_IMPORT = """\
import pathlib, time
pathlib.Path("importing").touch()
time.sleep(60)
"""


def test_while_the_command_is_still_loaded(tmp_path: Path) -> None:
    (tmp_path / "argparse.py").write_text(SLOW_IMPORT)
    process = start(tmp_path, "--version")
    wait_for(tmp_path / "importing", process)
    assert interrupt(process) == (130, "", "")


def test_while_a_package_is_still_loaded(tmp_path: Path) -> None:
    (tmp_path / "blink.csp").write_text(DRIVEN)
    (tmp_path / "lamp.py").write_text(LAMP)
    assert main(["compile", str(tmp_path / "blink.csp"), "-o", str(tmp_path)]) == 0
    folder = tmp_path / "blink"
    (folder / "argparse.py").write_text(SLOW_IMPORT)
    process = start_python(folder, "blink")
    wait_for(folder / "importing", process)
    assert interrupt(process) == (130, "", "")
