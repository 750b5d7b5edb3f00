"""``python -m NAME --tune``: a generated package changes its parameters without cspdiag."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import cspdiag

TEXT = """enum Mode { slow, fast }
struct Gains { kp: double<rad/s>  ti: time  class: int[2] }
parameter gains : Gains = Gains(kp = 1<rad/s>, ti = 10 ms, class = [1, 2])
parameter mode : Mode = Mode.slow
parameter on : bool = false
parameter names : int8 = 3
parameter near : float = 0.5
const twice = 2 * near

process Main {
  out y : double
  out n : int
  composition {
    mu (y ! gains.kp / 1<rad/s> * double(twice)
       ; n ! (if on and mode == Mode.fast then gains.class[1] else 12 / int(names))
       ; wait gains.ti)
  }
}
driver Printed python "printed.py:Printed" { in y : double  in n : int }
environment World for Main { printed : Printed  y -> printed.y  n -> printed.n }
"""
DRIVER = """class Printed:
    def write(self, port, value):
        print(f"{port}={value:g}", flush=True)
"""


@pytest.fixture(scope="module", params=[0, 1])
def package(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("tuned")
    (folder / "printed.py").write_text(DRIVER)
    (folder / "main.csp").write_text(TEXT)
    for path, text in cspdiag.load(folder / "main.csp").compile(level=request.param).items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text)
    return folder


def run(package: Path, changes: str, *options: str) -> tuple[list[str], list[str], int]:
    """What the driver was given before the safe values at the end, what was said, and the exit code."""
    done = subprocess.run(
        [sys.executable, "-m", "main", *options],
        input=changes,
        cwd=package,
        capture_output=True,
        text=True,
        check=False,
        timeout=30,
    )
    return [line for line in done.stdout.splitlines() if "=" in line][:-2], done.stderr.splitlines(), done.returncode


def test_changes_of_a_file_and_of_standard_input(package: Path) -> None:
    changes = "near = 1 # more\n\nat 10 ms gains.kp = 2\nat 20 ms mode = Mode.fast\nat 20 ms on = true\n"
    changes += "at 25 ms gains.class[1] = -7\nat 25 ms gains.ti = 1 s\n"
    (package / "changes.txt").write_text(changes)
    expected = ["y=2", "n=4", "y=4", "n=4", "y=4", "n=2", "y=4", "n=-7"]
    assert run(package, "", "--for", "50ms", "--tune", "changes.txt") == (expected, [], 0)
    assert run(package, changes, "--for", "50ms", "--tune") == (expected, [], 0)


def test_in_real_time_lines_take_effect_as_they_come(package: Path) -> None:
    printed, said, code = run(
        package, "oops\nnames = 6\nat 400 ms names = 1", "--for", "800ms", "--real-time", "--tune"
    )
    assert code == 0
    assert said == ["main: --tune, line 1: a change is NAME = VALUE, or at TIME NAME = VALUE, not 'oops'"]
    numbers = [line for line in printed if line.startswith("n=")]
    assert {"n=2", "n=12"} <= set(numbers) <= {"n=4", "n=2", "n=12"}  # n=4 until the first line is read.
    assert numbers[-1] == "n=12"


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("q = 1", "there is no parameter 'q' (there are: gains, mode, on, names, near)"),
        ("twice = 1", "twice does not change by itself: it follows from parameters"),
        ("gains = 1", "gains: set one of its parts: kp, ti, class"),
        ("gains.x = 1", "there is no 'gains.x': gains has these parts: kp, ti, class"),
        ("gains.class[2] = 1", "there is no 'gains.class[2]': gains.class has these parts: [0], [1]"),
        ("near.x = 1", "there is no 'near.x': near has no parts"),
        ("gains.ti = 10", "gains.ti: '10' is not a duration such as 20s or 500ms (there are ns, us, ms, s, min)"),
        ("names = 10 ms", "names: '10 ms' is no integer"),
        ("mode = other", "mode: 'other' is none of slow, fast"),
        ("on = 1", "on: '1' is neither true nor false"),
        ("gains.kp = 30<deg/s>", "gains.kp: '30<deg/s>' is not a number; its unit is that of the parameter"),
        ("at 2 kp = 1", "a change is NAME = VALUE, or at TIME NAME = VALUE, not 'at 2 kp = 1'"),
    ],
)
def test_a_wrong_line_is_reported_and_the_run_continues(package: Path, line: str, reason: str) -> None:
    printed, said, code = run(package, f"\n{line}\nnear = 1\n", "--for", "5ms", "--tune")
    assert said == [f"main: --tune, line 2: {reason}"]
    assert (printed, code) == (["y=2", "n=4"], 0)


def test_a_change_that_makes_no_sense_is_refused(package: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "main", "--for", "15ms", "--tune"],
        input="at 10 ms names = 300\n",
        cwd=package,
        capture_output=True,
        text=True,
        check=True,
        timeout=30,
    )
    assert "names was not changed at 10 ms: 300 is outside int8" in done.stdout


def test_a_file_that_is_not_there(package: Path) -> None:
    assert run(package, "", "--tune", "none.txt") == ([], ["--tune none.txt: No such file or directory"], 2)


def test_a_program_without_parameters(tmp_path: Path) -> None:
    for path, text in cspdiag.parse("process Main { composition { skip } }", "main.csp").compile().items():
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(text)
    assert run(tmp_path, "", "--tune")[1:] == (["main has no parameters that --tune could change"], 2)
