"""Python bodies that do not match what the program says about them: one line, the place, exit code 1."""

from __future__ import annotations

from pathlib import Path

import pytest

import cspdiag
from cspdiag.cli.main import main
from cspdiag.simulate.run.execute import BodyError

PROGRAM = """\
submodel Plant(tau: double) python "plant.py:Plant" {
  in  valve : double
  out level : double
}

submodel Law python "plant.py:Law" {
  in  level : double
  out valve : double
}

process Main {
  in  level : double @ 10 ms
  out valve : double @ 10 ms

  communication {
    law : Law

    level     -> law.level
    law.valve -> valve
  }

  composition {
    mu law
  }
}

environment Bench for Main {
  plant : Plant(tau = 2)

  valve       -> plant.valve
  plant.level -> level
}
"""

MODULE = """\
class Plant:
    def __init__(self, *, tau):
        self.tau = tau

    def calculate(self, valve):
        return valve / self.tau


class Law:
    def calculate(self, level):
        return 1 - level
"""


@pytest.fixture
def program(tmp_path: Path) -> Path:
    path = tmp_path / "tank.csp"
    path.write_text(PROGRAM)
    return path


@pytest.mark.parametrize(
    ("good", "bad", "reported"),
    [
        ("valve / self.tau", "valve / 0", (
            "at 0 s: the environment Bench failed: ZeroDivisionError: float division by zero, at plant.py:6"
        )),
        ("def calculate(self, valve)", "def calc(self, valve)", "the environment Bench failed: AttributeError: "),
        ("1 - level", "1 - levle", (
            "at 10 ms: NameError: name 'levle' is not defined, in Main.law (tank.csp:6), at plant.py:11"
        )),
        ("def calculate(self, level)", "def calculate(self)", "'level', in Main.law (tank.csp:6)"),
        ("*, tau", "*, time", "cspdiag: TypeError: Plant.__init__() got an unexpected keyword argument 'tau'"),
        ("self.tau = tau", "raise OSError('no table')", "cspdiag: plant.py:3: OSError: no table"),
        ("class Plant:", "import no_such_thing\nclass Plant:", "cspdiag: plant.py:1: ModuleNotFoundError: No module"),
        ("valve / self.tau", "valve / (", "cspdiag: plant.py:6: '(' was never closed"),
    ],
)  # fmt: skip
def test_a_failing_body_is_reported_in_one_line(
    program: Path, capsys: pytest.CaptureFixture[str], good: str, bad: str, reported: str
) -> None:
    program.with_name("plant.py").write_text(MODULE.replace(good, bad, 1))
    assert main(["run", str(program), "--for", "50ms"]) == 1
    shown = capsys.readouterr().err
    assert reported in shown
    assert "internal error" not in shown


def test_a_body_that_cannot_be_made_is_an_error_in_python_too(program: Path) -> None:
    program.with_name("plant.py").write_text(MODULE.replace("*, tau", "*, time"))
    with pytest.raises(BodyError, match="unexpected keyword argument 'tau'"):
        cspdiag.load(program).run(until="50 ms")


def test_a_fault_of_the_environment_names_its_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "count.csp"
    path.write_text(
        "process Main {\n  in x : int @ 10 ms\n  communication { var v : int = 0 }\n  composition { mu x ? v }\n}\n"
        "submodel Source {\n  out y : int\n  let k = int(floor(time / 100 ms))\n  y = 10 / (3 - k)\n}\n"
        "environment Bench for Main {\n  source : Source\n  source.y -> x\n}\n"
    )
    assert main(["run", str(path)]) == 1
    reported = "ended unsuccessfully at 310 ms: the environment Bench failed: Fault: division by zero, in count.csp:9"
    assert reported in capsys.readouterr().err


def test_a_missed_deadline_names_process_and_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "slow.csp"
    path.write_text(
        "process Main {\n  in x : int @ 10 ms\n  communication { var v : int = 0 }\n"
        "  composition { mu (x ? v ; wait 50 ms) }\n}\n"
        "submodel Source {\n  out y : int\n  y = 1\n}\n"
        "environment Bench for Main {\n  source : Source\n  source.y -> x\n}\n"
    )
    assert main(["run", str(path)]) == 1
    assert "before it had been taken, in Main (slow.csp:4)" in capsys.readouterr().err


def test_an_installed_module_that_is_missing_is_named(tmp_path: Path) -> None:
    (tmp_path / "lamp.csp").write_text(
        'driver Lamp python "no_such_module.lamp:Lamp" { in light : int }\n'
        "process P { out light : int composition { light ! 1 } }\n"
        "environment Real for P { lamp : Lamp light -> lamp.light }\n"
    )
    with pytest.raises(BodyError, match="ModuleNotFoundError: No module named 'no_such_module'"):
        cspdiag.load(str(tmp_path / "lamp.csp")).run()


DRIVEN = """\
submodel Amplifier python "amplifier.py:Amplifier" {
  in  valve : double
  out flow  : double
}

submodel Tank {
  in  flow  : double
  out level : double

  STATES
}

process Main {
  in  level : double @ 1 ms
  out valve : double @ 1 ms

  communication {
    var measured : double
  }

  composition {
    mu (level ? measured ; valve ! 1.0)
  }
}

environment Bench for Main {
  amplifier : Amplifier
  tank      : Tank

  valve          -> amplifier.valve
  amplifier.flow -> tank.flow
  tank.level     -> level
}
"""
AMPLIFIER = "class Amplifier:\n    def calculate(self, valve):\n        return 2.0 * valve\n"
STATES = {
    "a sum": ("state total : double = 0\n  next total = total + flow\n  level = total", [0, 0, 0, 2, 4]),
    "an integral": (
        "state total : double = 0\n  der total = 1000<s^-1> * flow\n  level = total",
        [0, 0, 0, 2, 4],
    ),
}


@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize("states", STATES)
def test_what_a_body_computes_drives_states(tmp_path: Path, states: str, level: int) -> None:
    text, expected = STATES[states]
    (tmp_path / "amplifier.py").write_text(AMPLIFIER)
    program = tmp_path / "tank.csp"
    program.write_text(DRIVEN.replace("STATES", text))
    run = cspdiag.load(str(program)).run(until="5 ms", level=level)
    assert run.outcome.ended == "time limit", run.outcome.error
    assert run["level"].tolist() == pytest.approx(expected)
