"""Drivers of environments that fail or are missing: what `run`, `compile` and a package report."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import cspdiag
from cspdiag.cli.main import main

PROGRAM = """
const failing = 0

driver Card(failing: int) python "card.py:Card" {
  out level : double
  in  valve : double
}

process Main {
  in  level : double @ 10 ms
  out valve : double @ 10 ms safe -1

  communication {
    var last : double = 0
  }

  composition {
    mu (level ? last ; valve ! last)
  }
}

environment Bench for Main {
  card : Card(failing)

  card.level -> level
  valve      -> card.valve
}
"""

MODULE = """
OPERATIONS = ("none", "open", "read", "write", "close")


class Card:
    def __init__(self, *, failing):
        self.failing = OPERATIONS[failing]
        self.written = []

    def _may_fail(self, operation):
        if operation == self.failing:
            raise OSError("cable out")

    def open(self):
        self._may_fail("open")

    def read(self, port):
        self._may_fail("read")
        return 1.0

    def write(self, port, value):
        print("valve", value)
        if value != -1:
            self._may_fail("write")

    def close(self):
        print("closed")
        self._may_fail("close")
"""


@pytest.fixture
def program(tmp_path: Path) -> Path:
    path = tmp_path / "valve control.csp"
    path.write_text(PROGRAM)
    (tmp_path / "card.py").write_text(MODULE)
    return path


def _run(program: Path, operation: int, *options: str) -> int:
    return main(["run", str(program), "--for", "50ms", "--set", f"failing={operation}", *options])


@pytest.mark.parametrize(("operation", "words"), [(2, "read at port Main.level"), (3, "write at port Main.valve")])
def test_a_failing_driver_is_named_with_its_port_and_outputs_are_released(
    program: Path, operation: int, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert _run(program, operation) == 1
    shown = capsys.readouterr()
    assert f": driver Card failed to {words}: OSError: cable out, at card.py:12\n" in shown.err
    assert shown.out.endswith("valve -1.0\nclosed\n")


def test_a_driver_that_does_not_open_ends_the_run_before_it_began(
    program: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert _run(program, 1) == 1
    assert "at 0 s: driver Card failed to open at port Main.level" in capsys.readouterr().err


@pytest.mark.parametrize("start", ["run", "package"])
def test_without_a_tick_there_is_no_jitter(program: Path, tmp_path: Path, start: str) -> None:
    main(["compile", str(program), "-o", str(tmp_path / "out"), "--set", "failing=1"])
    command = ["valve_control"] if start == "package" else ["cspdiag", "run", str(program), "--set", "failing=1"]
    result = subprocess.run(
        [sys.executable, "-m", *command, "--real-time"],
        cwd=tmp_path / "out/valve_control",
        capture_output=True,
        text=True,
    )
    assert "failed to open" in result.stdout + result.stderr
    assert "jitter" not in result.stdout + result.stderr


@pytest.mark.parametrize("options", [(), ("--quiet",)])
def test_a_driver_that_does_not_close_is_reported_at_the_end(
    program: Path, options: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    assert _run(program, 4, *options) == 1
    assert (
        "driver Card failed to close at port Main.level: OSError: cable out, at card.py:12\n" in capsys.readouterr().err
    )


def test_a_package_says_when_and_then_why(program: Path, tmp_path: Path) -> None:
    assert main(["compile", str(program), "-o", str(tmp_path / "out"), "--set", "failing=2"]) == 0
    result = subprocess.run(
        [sys.executable, "-m", "valve_control"],
        cwd=tmp_path / "out/valve_control",
        env={**os.environ, "PYTHONPATH": ""},
        capture_output=True,
        text=True,
    )
    last = result.stdout.splitlines()[-1]
    assert last.startswith("ended unsuccessfully at 10 ms, in ")
    assert last.endswith(" s: driver Card failed to read at port Main.level: OSError: cable out, at card.py:12")
    assert result.returncode == 1


@pytest.mark.parametrize("verb", ["run", "compile"])
def test_a_class_missing_in_its_module_is_reported_in_one_line(
    program: Path, verb: str, capsys: pytest.CaptureFixture[str]
) -> None:
    program.write_text(PROGRAM.replace("card.py:Card", "card.py:Crad"))
    assert main([verb, str(program), *(["--for", "1s"] if verb == "run" else [])]) == 1
    assert capsys.readouterr().err == f"cspdiag: {program}:4: card.py has no class `Crad`\n"
    with pytest.raises(ValueError, match="no class `Crad`"):
        cspdiag.load(program).run(until="1 s")


def test_a_run_against_the_clock_is_not_called_simulated(program: Path, capsys: pytest.CaptureFixture[str]) -> None:
    program.write_text(PROGRAM.replace("for Main {", "for Main on miss count {"))
    assert _run(program, 0, "--real-time") == 0
    shown = capsys.readouterr().err
    assert "ran 50 ms against the clock" in shown
    assert "simulated" not in shown


@pytest.mark.parametrize("start", ["run", "package"])
def test_a_run_against_the_clock_says_how_many_samples_it_missed(program: Path, tmp_path: Path, start: str) -> None:
    """A law that computes for longer than a period is certain to miss samples."""
    program.write_text(
        PROGRAM.replace("mu (level ? last", "mu (slow ; level ? last")
        .replace("var last : double = 0", "var last : double = 0\n    slow : Slow")
        .replace("process Main", 'submodel Slow python "card.py:Slow" { }\n\nprocess Main')
        .replace("for Main {", "for Main on miss count {")
    )
    slow = "import time\n\n\nclass Slow:\n    def calculate(self):\n        time.sleep(0.025)\n"
    (tmp_path / "card.py").write_text(f"{slow}\n{MODULE}")
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}
    command = ["cspdiag", "run", str(program)]
    if start == "package":
        assert main(["compile", str(program), "-o", str(tmp_path / "out")]) == 0
        command = ["valve_control"]
        environment["PYTHONPATH"] = str(tmp_path / "out/valve_control")
    done = subprocess.run(
        [sys.executable, "-m", *command, "--real-time", "--for", "300ms"],
        env=environment, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    reported = re.search(r"missed samples: (Main\.)?level (\d+)", done.stdout + done.stderr)
    assert reported is not None, done.stdout + done.stderr
    assert int(reported[2]) >= 5


@pytest.mark.parametrize("level", ["-O0", "-O1"])
@pytest.mark.parametrize(
    ("type_", "returned", "message"),
    [
        ("Gear", "True", "TypeError: True is no Gear"),
        ("Gear", "1.0", "TypeError: 1.0 is no Gear"),
        ("Gear", "7", "ValueError: 7 is not a valid Gear"),
        ("int8", "True", "TypeError: True is no integer"),
        ("int8", "1.0", "TypeError: 1.0 is no integer"),
        ("double", "True", "TypeError: True is not a number"),
        ("bool", "1.0", "TypeError: 1.0 is neither True nor False"),
        ("Gear[2]", "(0, True)", "TypeError: True is no Gear"),
        ("Gear[2]", "{0, 1}", "TypeError: {0, 1} is no sequence of 2 values"),
        ("Pose", "(1.0, False)", "TypeError: False is no Gear"),
    ],
)
def test_a_value_of_another_type_is_refused_with_driver_and_port(
    level: str, type_: str, returned: str, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    program = tmp_path / "main.csp"
    program.write_text(
        "enum Gear { park, drive }\n"
        "struct Pose { x : double  gear : Gear }\n"
        f'driver Card python "card.py:Card" {{ out level : {type_} }}\n'
        f"process Main {{ in level : {type_} @ 10 ms\n"
        f"  communication {{ var last : {type_} }}\n"
        "  composition { mu (level ? last) }\n}\n"
        "environment Bench for Main { card : Card  card.level -> level }\n"
    )
    (tmp_path / "card.py").write_text(f"class Card:\n    def read(self, port):\n        return {returned}\n")
    assert main(["run", level, str(program), "--for", "20ms"]) == 1
    assert f"driver Card failed to read at port Main.level: {message}\n" in capsys.readouterr().err
