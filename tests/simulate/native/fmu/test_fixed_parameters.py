"""Constants, and arguments of instances, are fixed parameters of FMUs as far as nothing that is compiled depends on
their values.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import cspdiag
from cspdiag.cli.main import main
from tests.simulate.native.fmu.master import Instance, together

pytest.importorskip("fmpy")

PROGRAM = """\
const period = 10 ms
/// How strongly it reacts.
const gain = 2<1/m>
const twice = 2 * gain
enum Mode { slow, fast }

process Tank(mode: Mode = Mode.fast) {
  in  level   : double<m> @ period
  out opening : double    @ period safe 0

  communication {
    valve : Valve(target = 1.5<m>, filter = 100 ms, samples = 2)
    level -> valve.level
    valve.opening -> opening
  }
  composition { mu (if mode == Mode.fast then valve else (valve ; valve)) }
}

submodel Valve(target: double<m>, filter: time, samples: int, bias: double<m> = target / 100) {
  in  level   : double<m>
  out opening : double
  let difference = lag(target + bias - level, filter)
  opening = limit(twice * delay(difference, samples, 0<m>), 0, 1)
}

const outflow = 0.2<1/s>

submodel Water(inflow: double<m/s> = 0.5<m/s>, leak: double<1/s>, wave: double<m> = 0<m>) {
  in  opening : double
  out level   : double<m>
  state content : double<m> = 1<m>
  let area = 1<m^2/s> / inflow
  der content = 1<m^2/s> / area * opening - leak * content
  level = content + wave * sin(10 * time / 1<s>)
}

/// Water that flows out faster when there is more of it.
submodel Sink(rate: double<1/s> = 0.1<1/s>, samples: int = 3) {
  in  level : double<m>
  out lost  : double<m>
  state s : double<m> = 0<m>
  der s = rate * sqrt(abs(level / 1<m>)) * 1<m>
  lost = delay(s, samples, 0<m>)
}

environment Bench for Tank {
  water : Water(leak = outflow)
  sink  : Sink
  opening     -> water.opening
  water.level -> level, sink.level
  sink.lost   -> _
}
"""


@pytest.fixture(scope="module", params=["2.0", "3.0"])
def fmus(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """The program, and its environment."""
    folder = tmp_path_factory.mktemp("tank")
    (folder / "tank.csp").write_text(PROGRAM)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CFLAGS", "-O0")
        for options in ([], ["--environment", "Bench"]):
            command = ["compile", str(folder / "tank.csp"), "--target", "fmu", "--fmi", request.param]
            assert main([*command, "-o", str(folder), *options]) == 0
    return folder / "tank.fmu", folder / "tank_bench.fmu"


def fixed(one: Instance) -> dict[str, Any]:
    return {name: item.start for name, item in one.variables.items() if item.variability == "fixed"}


def test_what_decides_nothing_but_numbers_can_be_set(fmus: tuple[Path, Path], tmp_path: Path) -> None:
    with Instance(fmus[0], tmp_path / "program") as one:
        assert list(fixed(one)) == ["gain", "mode", "valve.target"]
        assert float(one.variables["valve.target"].start) == 1.5
        assert one.variables["gain"].description == "How strongly it reacts."
        assert one.variables["gain"].unit == "1/m"
    with Instance(fmus[1], tmp_path / "plant") as one:
        # `sink.samples` is the number of states of a delay.
        assert list(fixed(one)) == ["water.inflow", "water.leak", "water.wave", "sink.rate"]


def test_the_rest_is_listed_with_the_reason(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "tank.csp").write_text(PROGRAM)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CFLAGS", "-O0")
        assert main(["compile", str(tmp_path / "tank.csp"), "--target", "fmu", "-o", str(tmp_path)]) == 0
    said = capsys.readouterr().err
    assert "  no parameters of the FMU: period (a sample instant, on which the schedule depends)\n" in said
    assert (
        "  no parameters of the FMU: valve.filter, valve.samples (a coefficient that is computed when the program is "
        "compiled)\n" in said
    )


SETTINGS = {"gain": 3.0, "valve.target": 1.25, "water.leak": 0.3, "water.inflow": 0.75, "water.wave": 0.01}


@pytest.mark.parametrize("names", [["gain", "valve.target"], ["water.leak", "water.inflow"], list(SETTINGS)])
def test_values_are_those_of_a_run_with_these_settings(
    fmus: tuple[Path, Path], tmp_path: Path, names: list[str]
) -> None:
    (tmp_path / "tank.csp").write_text(PROGRAM)
    settings = {name: SETTINGS[name] for name in names}
    run = cspdiag.load(str(tmp_path / "tank.csp")).run(until=1, set=settings)
    with Instance(fmus[0], tmp_path / "program") as tank, Instance(fmus[1], tmp_path / "plant") as plant:
        for one in (tank, plant):
            for name in set(names) & set(fixed(one)):
                one.set(name, SETTINGS[name])
        stepped = [values for _, values in together(tank, plant, 0.9, 0.01)]
    # A run records what is written at an instant, an FMU shows it at the end of the step from there.
    openings, levels = ([values[name] for values in stepped] for name in ("opening", "level"))
    assert openings[1:] == list(run["opening"])[: len(stepped) - 1]
    assert levels == list(run["level"])[: len(stepped)]
    assert (len(set(openings)), len(set(levels))) >= (8, 80)


def test_what_was_set_before_is_the_value_at_the_start(tmp_path: Path) -> None:
    (tmp_path / "tank.csp").write_text(PROGRAM)
    settings = [word for name in ("gain", "valve.target") for word in ("--set", f"{name}={SETTINGS[name]}")]
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CFLAGS", "-O0")
        command = ["compile", str(tmp_path / "tank.csp"), "--target", "fmu", "-o", str(tmp_path), *settings]
        assert main(command) == 0
    with Instance(tmp_path / "tank.fmu", tmp_path / "program") as one:
        assert {name: float(start) for name, start in fixed(one).items() if name != "mode"} == {
            "gain": 3.0,
            "valve.target": 1.25,
        }


def test_instances_have_their_own_values(fmus: tuple[Path, Path], tmp_path: Path) -> None:
    with Instance(fmus[1], tmp_path / "plant") as one:
        other = one.instance("other")
        one.set("water.leak", 0.4)
        one.set("water.leak", 0.1, other)
        one.begin()
        one.begin(other)
        for fmu in (one.fmu, other):
            one.step(0.0, 0.5, fmu)
        assert one.get("level") < one.get("level", other)
        assert (one.get("water.leak"), one.get("water.leak", other)) == (0.4, 0.1)


def test_a_value_may_be_set_until_the_initialization_ends(fmus: tuple[Path, Path], tmp_path: Path) -> None:
    with Instance(fmus[1], tmp_path / "plant") as one:
        one.begin()
        with pytest.raises(Exception, match="status 3"):
            one.set("water.leak", 0.4)
        assert "cannot be set any more: it is a fixed parameter" in one.messages[-1]


def test_values_that_it_cannot_have_are_errors_with_the_reason(fmus: tuple[Path, Path], tmp_path: Path) -> None:
    with Instance(fmus[0], tmp_path / "program") as one:
        with pytest.raises(Exception, match="status 3"):
            one.set("gain", float("inf"))
        assert one.messages[-1].startswith("gain (value reference")
        assert one.messages[-1].endswith("does not have this value: it is not finite")
        with pytest.raises(Exception, match="status 3"):
            one.set("mode", 3)
        assert one.messages[-1].endswith("does not have this value: it is out of range")
    with Instance(fmus[1], tmp_path / "plant") as one:
        one.set("water.inflow", 0.0)
        with pytest.raises(Exception, match="status 3"):
            one.begin()
        assert "division by zero, in Bench (tank.csp:" in one.messages[-1]
