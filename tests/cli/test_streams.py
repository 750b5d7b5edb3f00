"""Standard streams that are closed or full: output is either needed or not, and is never lost silently."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = """
submodel Law {
  in  x : double
  out y : double
  y = 0 - x / 2
}
process Main {
  in  x : double @ 10 ms
  out y : double @ 10 ms
  communication {
    law : Law
    x -> law.x
    law.y -> y
  }
  composition { mu law }
}
submodel Plant {
  in  u : double
  out y : double
  state s : double = 1
  next s = s + u
  y = s
}
environment Bench for Main {
  plant : Plant
  y -> plant.u
  plant.y -> x
}
assert Main deadlock free
"""

FOR_PEOPLE = (
    ("check", "main.csp"),
    ("compile", "main.csp", "-o", "out"),
    ("run", "main.csp", "--for", "50ms", "--record", "out.csv"),
    ("verify", "main.csp", "--no-cache"),
)
"""These report on standard error, and need no standard output."""

FOR_MACHINES = (
    ("check", "--format", "json", "main.csp"),
    ("verify", "--format", "json", "main.csp", "--no-cache"),
    ("draw", "--diagram", "composition", "-o", "-", "main.csp"),
    ("explain",),
    ("run", "--help"),
    ("--version",),
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "main.csp").write_text(PROGRAM)
    return tmp_path


def shell(folder: Path, command: tuple[str, ...], redirection: str) -> tuple[int, str, str]:
    """Run a command as a shell does; returns exit code, standard output, standard error."""
    line = f'"$@" {redirection}'
    done = subprocess.run(
        ["sh", "-c", line, "sh", sys.executable, *command],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        env={**os.environ, "PYTHONDEVMODE": ""},
    )
    return done.returncode, done.stdout, done.stderr


def cspdiag(folder: Path, command: tuple[str, ...], redirection: str) -> tuple[int, str, str]:
    return shell(folder, ("-m", "cspdiag", *command), redirection)


@pytest.mark.parametrize("command", FOR_PEOPLE, ids=lambda command: command[0])
def test_a_command_that_prints_nothing_needs_no_standard_output(folder: Path, command: tuple[str, ...]) -> None:
    code, _, error = cspdiag(folder, command, ">/dev/full")
    assert code == 0, error
    assert error
    assert "cspdiag:" not in error


@pytest.mark.parametrize("command", FOR_PEOPLE, ids=lambda command: command[0])
def test_without_any_stream_the_work_is_done(folder: Path, command: tuple[str, ...]) -> None:
    assert cspdiag(folder, command, "<&- >&- 2>&-")[0] == 0
    if command[0] == "compile":
        assert (folder / "out" / "main" / "pyproject.toml").exists()
    if command[0] == "run":
        table = (folder / "out.csv").read_text()
        assert all("," in line for line in table.splitlines()), (
            "what is said must not go into the first file that is opened"
        )
        assert cspdiag(folder, command, "2>/dev/full")[0] == 0


@pytest.mark.parametrize("command", FOR_MACHINES, ids=" ".join)
def test_output_that_cannot_be_printed_is_reported(folder: Path, command: tuple[str, ...]) -> None:
    code, _, error = cspdiag(folder, command, ">/dev/full")
    assert (code, error.splitlines()[-1]) == (2, "cspdiag: standard output: no space left on device")
    if command[0] == "check":
        code, _, error = cspdiag(folder, command, ">&-")
        assert (code, error.splitlines()[-1]) == (2, "cspdiag: standard output: it is closed")


def test_closed_standard_input_is_reported(folder: Path) -> None:
    code, _, error = cspdiag(folder, ("check", "-"), "<&-")
    assert (code, error) == (2, "cspdiag: standard input: it is closed\n")


def test_a_package_prints_its_summary_or_reports_that_it_cannot(folder: Path) -> None:
    assert cspdiag(folder, ("compile", "main.csp", "-o", "out"), "")[0] == 0
    package = folder / "out" / "main"
    run = ("-m", "main", "--for", "50ms")
    code, out, error = shell(package, run, "")
    assert (code, error) == (0, "")
    assert out.startswith("reached the time limit")
    code, _, error = shell(package, run, ">/dev/full")
    assert code == 1
    assert "the account of the run cannot be written: No space left on device\nreached the time limit" in error
    assert shell(package, run, "<&- >&- 2>&-") == (0, "", "")
    code, _, error = shell(package, ("-m", "main", "--help"), ">/dev/full")
    assert code == 1
    assert error.startswith("the help cannot be written: No space left on device\nusage: python -m main")
