"""FMUs of pythonfmu: binaries that need a Python around them."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path

import pytest

from cspdiag.cli.main import main

pytest.importorskip("fmpy")
builder = pytest.importorskip("pythonfmu.builder")

PYTHON = """\
from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class Heater(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.power = 0.0
        self.temperature = 20.0
        self.register_variable(Real("power", causality=Fmi2Causality.input))
        self.register_variable(Real("temperature", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        self.temperature += step_size * (self.power - 0.1 * (self.temperature - 20.0))
        return True
"""

HEATED = """\
process Thermostat {
  in  temperature : double @ 100 ms
  out power       : double @ 100 ms

  communication {
    var t : double = 0
  }

  composition {
    mu (temperature ? t ; power ! if t < 21 then 2 else 0)
  }
}

submodel Room fmu "Heater.fmu" {}

environment House for Thermostat {
  room : Room

  power            -> room.power
  room.temperature -> temperature
}
"""


def heater(count: int) -> Iterator[float]:
    """What the program and the FMU do, step by step: the output of a tick reaches the heater at the next one."""
    temperature, power, written = 20.0, 0.0, 0.0
    for _ in range(count):
        temperature += 0.1 * (power - 0.1 * (temperature - 20.0))
        power, written = written, 2.0 if temperature < 21 else 0.0
        yield temperature


@pytest.fixture
def house(tmp_path: Path) -> Path:
    """The program, beside its FMU."""
    (tmp_path / "heater.py").write_text(PYTHON)
    builder.FmuBuilder.build_FMU(str(tmp_path / "heater.py"), dest=str(tmp_path))
    (tmp_path / "house.csp").write_text(HEATED)
    return tmp_path / "house.csp"


def test_an_fmu_made_by_pythonfmu(house: Path, tmp_path: Path) -> None:
    for options in (["-O0"], ["-O1"], ["--target", "auto"]):
        place = tmp_path / "run.csv"
        assert main(["run", str(house), "--for", "5 s", "--record", str(place), *options]) == 0
        rows = list(csv.DictReader(place.read_text().splitlines()))
        found = [float(row["temperature"]) for row in rows]
        assert found == pytest.approx(list(heater(len(found))), abs=1e-12)


def test_an_exception_in_an_fmu_made_by_pythonfmu_is_shown(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    burnt = PYTHON.replace("        return True", "        raise ValueError('it is burnt')")
    (tmp_path / "burnt.py").write_text(burnt.replace("Heater", "Burnt"))  # A module of another name in this process.
    builder.FmuBuilder.build_FMU(str(tmp_path / "burnt.py"), dest=str(tmp_path))
    (tmp_path / "house.csp").write_text(HEATED.replace("Heater", "Burnt"))
    assert main(["run", str(tmp_path / "house.csp"), "--for", "5 s"]) == 1
    shown = "".join(capsys.readouterr())
    assert "Burnt.fmu returned a fatal error in fmi2DoStep, in the step from 0 s to 0.1 s: " in shown
    assert "ValueError('it is burnt')" in shown


def test_a_native_run_says_that_it_cannot_call_a_program_in_python(
    house: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", str(house), "--for", "1 s", "--target", "c"]) == 1
    shown = "".join(capsys.readouterr())
    assert "Heater.fmu is a Python program, as FMUs of pythonfmu are, which a native program cannot call" in shown
    assert "leave out --target c" in shown


def test_what_is_native_if_possible_runs_in_python(house: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", str(house), "--for", "1 s", "--target", "auto"]) == 0
    assert "Heater.fmu is a Python program" in "".join(capsys.readouterr())
    assert main(["sweep", str(house), "--for", "1 s", "--measure", "last(temperature)"]) == 0
    shown = "".join(capsys.readouterr())
    assert "Heater.fmu is a Python program" in shown
    assert "1 time limit" in shown


def test_a_sweep_without_a_run_that_succeeds_is_unsuccessful(house: Path, capsys: pytest.CaptureFixture[str]) -> None:
    house.with_name("Heater.fmu").unlink()
    burnt = PYTHON.replace("        return True", "        raise ValueError('it is burnt')").replace("Heater", "Ash")
    house.with_name("ash.py").write_text(burnt)
    builder.FmuBuilder.build_FMU(str(house.with_name("ash.py")), dest=str(house.parent))
    house.write_text(HEATED.replace("Heater", "Ash"))
    assert main(["sweep", str(house), "--for", "1 s", "--measure", "last(temperature)", "--quiet"]) == 1
    shown = "".join(capsys.readouterr())
    assert "no run has succeeded, the first one for this reason: the environment House failed" in shown
