"""Parameters of a program are tunable parameters of its FMU."""

from __future__ import annotations

from pathlib import Path

import pytest

from cspdiag.cli.main import main
from tests.simulate.native.fmu.master import Instance

pytest.importorskip("fmpy")

PROGRAM = """\
/// How much it is.
parameter gain : double = 2

/// Follows from it.
const twice = 2 * gain

process Amplifier {
  in  x : double @ 10 ms
  out y : double @ 10 ms

  communication {
    var v : double
  }

  composition {
    mu (x ? v ; y ! twice * v)
  }
}

submodel Source {
  in  y : double
  out x : double

  x = gain + 1
}

environment Bench for Amplifier {
  source : Source

  y        -> source.y
  source.x -> x
}
"""


@pytest.fixture(scope="module", params=["2.0", "3.0"])
def fmus(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """The program, and its environment, which uses the parameter too."""
    folder = tmp_path_factory.mktemp("amplifier")
    (folder / "amplifier.csp").write_text(PROGRAM)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CFLAGS", "-O0")
        for options in ([], ["--environment", "Bench"]):
            command = ["compile", str(folder / "amplifier.csp"), "--target", "fmu", "--fmi", request.param]
            assert main([*command, "-o", str(folder), *options]) == 0
    return folder / "amplifier.fmu", folder / "amplifier_bench.fmu"


def test_a_parameter_may_be_set_before_and_between_steps(fmus: tuple[Path, Path], tmp_path: Path) -> None:
    with Instance(fmus[0], tmp_path / "program") as one:
        assert one.variables["gain"].variability == "tunable"
        assert float(one.variables["gain"].start) == 2.0
        assert one.variables["gain"].description == "How much it is."
        one.set("gain", 3.0)
        one.set("x", 1.0)
        one.begin()
        one.step(0.0, 0.02)
        assert one.get("y") == 6.0
        one.set("gain", 5.0)
        assert one.get("gain") == 5.0
        one.step(0.02, 0.01)
        assert one.get("y") == 10.0
        one.fmu.reset()
        one.set("x", 1.0)
        one.begin()
        one.step(0.0, 0.02)
        assert one.get("y") == 4.0


def test_a_plant_follows_parameters_of_the_program(fmus: tuple[Path, Path], tmp_path: Path) -> None:
    with Instance(fmus[1], tmp_path / "plant") as one:
        one.begin()
        assert one.get("x") == 3.0
        one.set("gain", 5.0)
        one.step(0.0, 0.01)
        assert one.get("x") == 6.0


def test_a_value_that_the_program_cannot_have_is_an_error(fmus: tuple[Path, Path], tmp_path: Path) -> None:
    with Instance(fmus[0], tmp_path / "program") as one:
        one.begin()
        one.set("gain", float("nan"))
        with pytest.raises(Exception, match="status 3"):
            one.step(0.0, 0.01)
        assert one.messages[-1].endswith("the parameters have values that the program cannot have")
