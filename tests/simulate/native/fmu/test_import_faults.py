"""Parameters of FMUs of other tools, and FMUs that are damaged or fail: what is said, and what is left on disk."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from cspdiag.cli.main import main
from cspdiag.fmu.platforms import platform_folder
from cspdiag.simulate.record.stored.open_recording import open_recording
from tests.simulate.native.fmu.test_import import (
    LOOP,
    REFERENCE,
    TARGETS,
    damaged,
    needs_reference,
    quickly_compiled,
    recorded,
    tank,
    watching,
)
from tests.support.compiling import compile_once

__all__ = ["quickly_compiled", "tank"]

BALL = (
    "process Watch {{ in h : double<m> @ 10 ms communication {{ var v : double<m> }} composition {{ mu (h ? v) }} }}\n"
    'submodel Ball({parameters}) fmu "{folder}/2.0/BouncingBall.fmu" {{ out h : double<m> }}\n'
    "environment Bench for Watch {{ ball : Ball{given}  ball.h -> h }}\n"
)


@needs_reference
def test_a_file_of_its_resources_is_found(tmp_path: Path) -> None:
    text = watching({"y": "int"}, f"{REFERENCE}/2.0/Resource.fmu", "1 s")
    for options in TARGETS:
        assert [row["y"] for row in recorded(text, tmp_path, "2 s", options)] == ["97", "97"]


@needs_reference
def test_parameters_of_the_submodel_are_those_of_the_fmu(tmp_path: Path) -> None:
    def ball(given: str, *options: str) -> list[dict[str, str]]:
        text = BALL.format(folder=REFERENCE, parameters="e: double = 0.7", given=given)
        return recorded(text, tmp_path, "1 s", list(options))

    dull = [ball("(e = 0.5)", *options) for options in TARGETS]
    assert all(rows == dull[0] for rows in dull)
    assert ball("") != dull[0]
    assert ball("", "--set", "ball.e=0.5") == dull[0]


@needs_reference
@pytest.mark.parametrize(
    ("parameters", "reported"),
    [
        ("g: double<m> = 1<m>", "`g` has the unit m here, and m/s^2 in the FMU"),
        ("e: bool = true", "`e` is a bool here, and in the FMU a double"),
        ("v_min: double<m/s> = 1<m/s>", "the FMU has no parameter `v_min`"),
        ("h: double<m> = 1<m>", "the FMU has no parameter `h`"),
    ],
)
def test_parameters_that_do_not_fit(
    parameters: str, reported: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "ball.csp").write_text(BALL.format(folder=REFERENCE, parameters=parameters, given=""))
    assert main(["check", str(tmp_path / "ball.csp")]) == 1
    shown = capsys.readouterr()
    assert f"error[E0840]: {reported}" in shown.out + shown.err


@pytest.mark.parametrize("options", [["-O1"], ["--target", "c"]], ids=" ".join)
@pytest.mark.parametrize(
    ("name", "binary", "reported"),
    [
        ("missing", None, "missing.fmu has no binaries/"),
        ("garbage", b"garbage" * 100, "garbage.fmu cannot be loaded"),
        ("empty", b"", "empty.fmu cannot be loaded"),
    ],
)
def test_a_binary_that_is_missing_or_damaged(
    tank: Path,
    name: str,
    binary: bytes | None,
    reported: str,
    options: list[str],
    capsys: pytest.CaptureFixture[str],
) -> None:
    found: list[str] = []

    def keep(path: str) -> str | None:
        if path.startswith("binaries/"):
            found.append(path)
            return None
        return path

    damaged(tank, name, keep)
    added = {} if binary is None else {found[0]: binary}
    damaged(tank, name, keep, **added)
    (tank / f"{name}.csp").write_text(LOOP.format(fmu=f"{name}.fmu"))
    place = tank / f"{name}.mcap"
    assert main(["run", str(tank / f"{name}.csp"), "--environment", "AsFmu", "--record", str(place), *options]) == 1
    shown = capsys.readouterr()
    assert reported in shown.out + shown.err
    assert "fmpy compile" in shown.out + shown.err
    assert not list(tank.glob(f"{name}.part*"))
    assert not place.exists() or open_recording(str(place)).whole


def test_an_error_at_a_step_leaves_safe_outputs_and_a_whole_recording(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    desk = str(Path(__file__).parent / "desk.csp")
    assert main(["compile", desk, "--target", "fmu", "-o", str(tmp_path)]) == 0
    (tmp_path / "watch.csp").write_text(
        "process Watch {\n  in shown : int @ 2 ms\n  out weight : uint8 @ 2 ms safe 42\n"
        "  communication {\n    var x : int\n    var n : uint8 = 0\n  }\n"
        "  composition { mu (shown ? x ; n := n + 1 ; weight ! n) }\n}\n"
        'submodel Desk fmu "desk.fmu" { in weight : uint8  out shown : int }\n'
        "environment Bench for Watch {\n  desk : Desk\n  weight -> desk.weight\n  desk.shown -> shown\n}\n"
    )
    found = []
    for number, options in enumerate(TARGETS):
        place = tmp_path / f"{number}.mcap"
        assert main(["run", str(tmp_path / "watch.csp"), "--for", "1 s", "--record", str(place), *options]) == 1
        recording = open_recording(str(place))
        assert (recording.whole, recording.ended, recording.time) == (True, "failed", 18_000_000)
        time, weight = recording.values("weight")
        assert (int(time[-1]), int(weight[-1])) == (18_000_000, 42)
        found.append(recording.values("shown")[1].tolist())
    assert all(values == found[0] for values in found)
    assert not list(tmp_path.glob("*.part.*"))


REFUSING = """<?xml version="1.0"?>
<fmiModelDescription fmiVersion="2.0" modelName="Refusing" guid="{}">
  <CoSimulation modelIdentifier="refusing"/>
  <ModelVariables>
    <ScalarVariable name="y" valueReference="0" causality="output" variability="continuous"><Real/></ScalarVariable>
    <ScalarVariable name="u" valueReference="1" causality="input"><Real start="0"/></ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="1"/></Outputs></ModelStructure>
</fmiModelDescription>
"""

REFUSED = """
process Follow {
  in  y : double @ 10 ms
  out u : double @ 10 ms safe -7

  communication { var v : double }

  composition { mu (y ? v ; u ! v) }
}

submodel Plant fmu "refusing.fmu" {}

environment Bench for Follow {
  plant : Plant

  u       -> plant.u
  plant.y -> y
}
"""


def packed(folder: Path, source: str, description: str, *options: str) -> None:
    """Makes an FMU of a file in C and a description."""
    platform, suffix = platform_folder("2.0")
    library = folder / f"{source}{suffix}"
    compile_once("cc", *options, "-shared", "-fPIC", Path(__file__).parent / f"{source}.c", "-o", library)
    with zipfile.ZipFile(folder / f"{source}.fmu", "w") as archive:
        archive.writestr("modelDescription.xml", description)
        archive.write(library, f"binaries/{platform}/{source}{suffix}")


@pytest.mark.parametrize(("status", "word"), [(2, "discard"), (3, "an error"), (4, "a fatal error")])
def test_a_step_that_is_refused_ends_the_run_with_the_reason(
    status: int, word: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    packed(tmp_path, "refusing", REFUSING, f"-DSTATUS={status}")
    (tmp_path / "follow.csp").write_text(REFUSED)
    for number, options in enumerate(TARGETS):
        place = tmp_path / f"{number}.mcap"
        assert main(["run", str(tmp_path / "follow.csp"), "--for", "1 s", "--record", str(place), *options]) == 1
        shown = "".join(capsys.readouterr())
        assert f"refusing.fmu returned {word} in fmi2DoStep" in shown
        assert ": the tank is " in shown
        recording = open_recording(str(place))
        assert (recording.whole, recording.ended, recording.time) == (True, "failed", 60_000_000)
        time, value = recording.values("u")
        assert (int(time[-1]), float(value[-1])) == (60_000_000, -7.0)


STUBBORN = """<?xml version="1.0"?>
<fmiModelDescription fmiVersion="2.0" modelName="Stubborn" guid="{}" numberOfEventIndicators="0">
  <ModelExchange modelIdentifier="stubborn"/>
  <ModelVariables>
    <ScalarVariable name="y" valueReference="0" causality="output" variability="continuous"><Real/></ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="1"/></Outputs></ModelStructure>
</fmiModelDescription>
"""


@pytest.mark.parametrize(
    ("options", "reported"),
    [
        (
            [],
            "has updated its discrete states 1000 times at the event of 0.02 s; it does not get any further",
        ),
        (["-DSTUBBORN_ENDS"], "has ended the simulation at 0.02 s"),
    ],
    ids=["updates", "ends"],
)
def test_an_fmu_that_goes_no_further_ends_the_run(
    options: list[str], reported: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    packed(tmp_path, "stubborn", STUBBORN, *options)
    (tmp_path / "watch.csp").write_text(watching({"y": "double"}, "stubborn.fmu", "10 ms"))
    for target in TARGETS:
        assert main(["run", str(tmp_path / "watch.csp"), "--for", "1 s", *target]) == 1
        shown = capsys.readouterr()
        assert f"stubborn.fmu {reported}" in shown.out + shown.err
