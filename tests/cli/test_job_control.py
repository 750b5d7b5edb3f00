"""Signals of job control: how a shell treats a program that drives a machine, in a terminal of its own."""

from __future__ import annotations

import json
import os
import pty
import sys
from pathlib import Path

import pytest

from cspdiag.cli.main import main
from tests.cli.test_interrupt import DRIVEN, LAMP, ROOT

SHELL = """
import json, os, signal, subprocess, sys, termios, time
from pathlib import Path

how, *command = sys.argv[1:]
signal.signal(signal.SIGTTOU, signal.SIG_IGN)
termios.tcsetwinsize(0, (24, 20))
flags = termios.tcgetattr(0)
flags[3] |= termios.TOSTOP
termios.tcsetattr(0, termios.TCSANOW, flags)
child = subprocess.Popen(command, process_group=0, preexec_fn=lambda: signal.signal(signal.SIGTTOU, signal.SIG_DFL))
if how == "Ctrl-Z":
    os.tcsetpgrp(0, child.pid)
    while not Path("last").exists():
        time.sleep(0.02)
    child.send_signal(signal.SIGTSTP)
_, status = os.waitpid(child.pid, os.WUNTRACED)
if os.WIFSTOPPED(status):
    child.kill()
    child.wait()
    Path("status").write_text(json.dumps("stopped"))
else:
    Path("status").write_text(json.dumps(os.waitstatus_to_exitcode(status)))
"""
"""What a shell does after ``stty tostop``: ``how`` is ``&`` or ``Ctrl-Z``."""


def run_on_a_terminal(folder: Path, how: str, *command: str) -> tuple[object, str]:
    """How a command ended, and what the terminal shows."""
    pid, terminal = pty.fork()
    if pid == 0:
        os.chdir(folder)
        os.environ["PYTHONPATH"] = str(ROOT)
        os.execv(sys.executable, [sys.executable, "-c", SHELL, how, *command])
    shown = b""
    try:
        while data := os.read(terminal, 4096):
            shown += data
    except OSError:
        # The other end is closed everywhere.
        pass
    finally:
        os.close(terminal)
        os.waitpid(pid, 0)
    return json.loads((folder / "status").read_text()), shown.decode(errors="replace")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    # Its branches have names, which the progress line shows.
    text = DRIVEN.replace("mu (n := n + 1", "blinking_for_a_while : mu (n := n + 1")
    (tmp_path / "blink.csp").write_text(text)
    (tmp_path / "lamp.py").write_text(LAMP)
    return tmp_path


CSPDIAG = (sys.executable, "-m", "cspdiag", "run", "blink.csp", "--real-time", "--for", "700ms")


@pytest.mark.parametrize("how", ["&", "Ctrl-Z"])
def test_a_run_against_the_clock_is_not_stopped(folder: Path, how: str) -> None:
    status, shown = run_on_a_terminal(folder, how, *CSPDIAG)
    assert status == 0, shown
    assert "reached the time limit" in shown
    assert (folder / "closed").exists()
    lines = [line.partition("\r")[0] for line in shown.split("\x1b[K")[1:-1]]
    assert all(len(line) < 20 for line in lines), (
        "a line that is too long for the terminal would be repeated again and again"
    )
    assert ("\x1b[K" in shown) == (how == "Ctrl-Z"), "progress belongs to the foreground process"


@pytest.mark.parametrize("how", ["&", "Ctrl-Z"])
def test_a_package_against_the_clock_is_not_stopped(folder: Path, how: str) -> None:
    assert main(["compile", str(folder / "blink.csp"), "-o", str(folder)]) == 0
    package = folder / "blink"
    command = (sys.executable, "-m", "blink", "--real-time", "--for", "500ms")
    status, shown = run_on_a_terminal(package, how, *command)
    assert status == 0, shown
    assert "reached the time limit" in shown


def test_a_simulation_can_be_stopped_for_a_while(folder: Path) -> None:
    status, shown = run_on_a_terminal(folder, "Ctrl-Z", sys.executable, "-m", "cspdiag", "run", "blink.csp")
    assert status == "stopped", shown
