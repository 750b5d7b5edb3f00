"""FMUs of other tools in environments, on every target."""

from __future__ import annotations

import csv
import math
import os
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from cspdiag.cli.main import main

pytest.importorskip("fmpy")

ROOT = Path(__file__).parents[4]
NAME = "CSPDIAG_REFERENCE_FMUS"
REFERENCE = Path(os.environ.get(NAME, ROOT.parent / "shared" / "fmus"))
needs_reference = pytest.mark.skipif(
    not (REFERENCE / "2.0").is_dir(),
    reason=f"the Reference FMUs of the Modelica Association are not in {REFERENCE}; {NAME} names their folder",
)
TARGETS = (["-O0"], ["-O1"], ["--target", "c", "-O0"], ["--target", "c", "-O1"])


@pytest.fixture(autouse=True)
def quickly_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CFLAGS", "-O0")


def watching(outputs: dict[str, str], body: str, period: str, options: str = "") -> str:
    """A program that samples the outputs of an FMU, each of a type."""
    ports = "\n".join(f"  in {name} : {kind} @ {period}" for name, kind in outputs.items())
    variables = "\n".join(f"    var of_{name} : {kind}" for name, kind in outputs.items())
    reads = " ; ".join(f"{name} ? of_{name}" for name in outputs)
    wires = "\n".join(f"  fmu.{name} -> {name}" for name in outputs)
    return (
        f"process Watch {{\n{ports}\n  communication {{\n{variables}\n  }}\n  composition {{ mu ({reads}) }}\n}}\n"
        f'submodel Model fmu "{body}" {options} {{}}\n'
        f"environment Bench for Watch {{\n  fmu : Model\n{wires}\n}}\n"
    )


def recorded(text: str, folder: Path, until: str, options: list[str]) -> list[dict[str, str]]:
    """The rows of the recording of a run."""
    (folder / "watch.csp").write_text(text)
    place = folder / "run.csv"
    assert main(["run", str(folder / "watch.csp"), "--for", until, "--record", str(place), *options]) == 0
    return list(csv.DictReader(place.read_text().splitlines()))


def published(name: str) -> list[dict[str, str]]:
    return list(csv.DictReader((REFERENCE / f"{name}_out.csv").read_text().splitlines()))


MODELS = {
    "BouncingBall": ({"h": "double<m>", "v": "double<m/s>"}, "10 ms", "2.9 s"),
    "VanDerPol": ({"x0": "double", "x1": "double"}, "10 ms", "3 s"),
    "Dahlquist": ({"x": "double"}, "100 ms", "9 s"),
}


@needs_reference
@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
@pytest.mark.parametrize("name", MODELS)
def test_co_simulation_gives_the_published_results(name: str, fmi: str, tmp_path: Path) -> None:
    outputs, period, until = MODELS[name]
    text = watching(outputs, f"{REFERENCE}/{fmi}/{name}.fmu", period)
    runs = [recorded(text, tmp_path, until, options) for options in TARGETS]
    expected = published(name)[1:]
    assert len(runs[0]) > 80
    for rows in runs:
        for row, known in zip(rows, expected, strict=False):
            assert [float(row[port]) for port in outputs] == [float(known[port]) for port in outputs], row["time"]


@needs_reference
@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
@pytest.mark.parametrize(("name", "step"), [("VanDerPol", "10 ms"), ("Dahlquist", "100 ms")])
def test_model_exchange_by_eulers_method_gives_the_published_results(
    name: str, step: str, fmi: str, tmp_path: Path
) -> None:
    outputs, period, until = MODELS[name]
    path = f"{REFERENCE}/{fmi}/{name}.fmu:ModelExchange"
    text = watching(outputs, path, period, f"step {step} method = euler")
    runs = [recorded(text, tmp_path, until, options) for options in TARGETS]
    for rows in runs:
        assert rows == runs[0]
        for row, known in zip(rows, published(name)[1:], strict=False):
            assert [float(row[port]) for port in outputs] == pytest.approx(
                [float(known[port]) for port in outputs], rel=1e-12, abs=1e-13
            )


def flight(time: float) -> float:
    """The height of a ball that falls from 1 m and keeps 0.7 of its speed at each bounce."""
    fall, speed = math.sqrt(2 / 9.81), 0.7 * math.sqrt(2 * 9.81)
    if time <= fall:
        return 1 - 9.81 / 2 * time**2
    time -= fall
    while time > 2 * speed / 9.81:
        time -= 2 * speed / 9.81
        speed *= 0.7
    return speed * time - 9.81 / 2 * time**2


@needs_reference
@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
def test_events_are_located(fmi: str, tmp_path: Path) -> None:
    """Between two instants of the environment, to the precision of numbers: heights are those of the exact solution."""
    outputs, period, _ = MODELS["BouncingBall"]
    text = watching(outputs, f"{REFERENCE}/{fmi}/BouncingBall.fmu:ModelExchange", period)
    runs = [recorded(text, tmp_path, "2 s", options) for options in TARGETS]
    for rows in runs:
        assert rows == runs[0]
    for row in runs[0]:
        assert float(row["h"]) == pytest.approx(flight(float(row["time"])), abs=1e-10)


@needs_reference
@pytest.mark.parametrize("interface", ["", ":ModelExchange"])
@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
def test_inputs_and_outputs_of_all_types_pass_through(fmi: str, interface: str, tmp_path: Path) -> None:
    """A program against an FMU that hands its inputs on, sample by sample."""
    text = (
        "process Count {\n  in back : double @ 10 ms\n  in flag : bool @ 10 ms\n  in number : int32 @ 10 ms\n"
        "  out x : double @ 10 ms\n  out on : bool @ 10 ms\n  out n : int32 @ 10 ms\n"
        "  communication {\n    var a : double = 0\n    var b : bool = false\n    var c : int32 = 0\n  }\n"
        "  composition { mu (back ? a ; flag ? b ; number ? c ; x ! a + 0.5 ; on ! not b ; n ! c + int32(1)) }\n}\n"
        f'submodel Through fmu "{REFERENCE}/{fmi}/Feedthrough.fmu{interface}" {{\n'
        "  in Float64_continuous_input : double\n  in Boolean_input : bool\n  in Int32_input : int32\n"
        "  out Float64_continuous_output : double\n  out Boolean_output : bool\n  out Int32_output : int32\n}\n"
        "environment Bench for Count {\n  fmu : Through\n  x -> fmu.Float64_continuous_input\n"
        "  on -> fmu.Boolean_input\n  n -> fmu.Int32_input\n  fmu.Float64_continuous_output -> back\n"
        "  fmu.Boolean_output -> flag\n  fmu.Int32_output -> number\n}\n"
    )
    runs = [recorded(text, tmp_path, "0.2 s", options) for options in TARGETS]
    for rows in runs:
        assert rows == runs[0]
    last = runs[0][-1]
    assert (float(last["back"]), int(last["number"])) == (4.5, 9)


@needs_reference
@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
@pytest.mark.parametrize("interface", ["", ":ModelExchange"])
def test_an_enumeration_keeps_the_value_of_the_fmu_until_it_is_written(
    tmp_path: Path, fmi: str, interface: str
) -> None:
    text = (
        "process Count {\n  in back : int @ 10 ms\n  out n : int\n"
        "  communication { var a : int = 0 }\n"
        "  composition { back ? a ; back ? a ; n ! 2 ; mu (back ? a) }\n}\n"
        f'submodel Through fmu "{REFERENCE}/{fmi}/Feedthrough.fmu{interface}" {{\n'
        "  in Enumeration_input : int\n  out Enumeration_output : int\n}\n"
        "environment Bench for Count step 10 ms {\n  fmu : Through\n  n -> fmu.Enumeration_input\n"
        "  fmu.Enumeration_output -> back\n}\n"
    )
    runs = [recorded(text, tmp_path, "0.05 s", options) for options in TARGETS]
    for rows in runs:
        assert rows == runs[0]
    assert runs[0][0]["back"] == "1"
    assert runs[0][-1]["back"] == "2"


# ---- Without the Reference FMUs: FMUs that are made here


@pytest.fixture(scope="module")
def tank(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The plant of the page about FMI, as an FMU."""
    folder = tmp_path_factory.mktemp("tank")
    page = (ROOT / "docs" / "fmi.md").read_text(encoding="utf-8")
    (folder / "tank.csp").write_text(page.split("```csp\n")[1].split("```")[0])
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CFLAGS", "-O0")
        options = ["--target", "fmu", "--environment", "Bench", "-o", str(folder)]
        assert main(["compile", str(folder / "tank.csp"), *options]) == 0
    return folder


LOOP = """\
import "tank.csp"

submodel Plant fmu "{fmu}" {{}}

environment AsFmu for Tank {{
  plant : Plant

  opening     -> plant.opening
  plant.level -> level
}}
"""


def test_a_plant_as_an_fmu_gives_the_bits_of_the_plant_itself(tank: Path, tmp_path: Path) -> None:
    (tank / "loop.csp").write_text(LOOP.format(fmu="tank_bench.fmu"))
    found = []
    for options in (["--environment", "Bench"], *(["--environment", "AsFmu", *target] for target in TARGETS)):
        place = tmp_path / "run.csv"
        assert main(["run", str(tank / "loop.csp"), "--for", "3 s", "--record", str(place), *options]) == 0
        found.append(place.read_text())
    assert len(found[0].splitlines()) > 300
    assert all(text == found[0] for text in found)


def damaged(folder: Path, name: str, keep: Callable[[str], str | None], **added: bytes) -> Path:
    """The FMU of the plant with other names of its files, and further files."""
    place = folder / f"{name}.fmu"
    with zipfile.ZipFile(folder / "tank_bench.fmu") as source, zipfile.ZipFile(place, "w") as target:
        for entry in source.infolist():
            kept = keep(entry.filename)
            if kept is not None:
                target.writestr(kept, source.read(entry))
        for path, data in added.items():
            target.writestr(path, data)
    return place


@pytest.mark.parametrize("options", [["-O1"], ["--target", "c"]], ids=" ".join)
def test_an_fmu_for_other_platforms_is_named(
    tank: Path, options: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    place = damaged(tank, "an other", lambda name: "binaries/win64/x.dll" if name.startswith("binaries/") else name)
    (tank / "other.csp").write_text(LOOP.format(fmu="an other.fmu"))
    assert main(["run", str(tank / "other.csp"), "--environment", "AsFmu", *options]) == 1
    reported = capsys.readouterr().err
    assert f"cspdiag: {tank}/other.csp:3: {place} has binaries for win64, none for this machine" in reported
    assert f"fmpy compile '{place}'" in reported


@pytest.mark.parametrize("options", [["-O1"], ["--target", "c"]], ids=" ".join)
def test_nothing_is_written_outside_of_the_folder(
    tank: Path, options: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    damaged(tank, "escaping", lambda name: name, **{"../../escaped.txt": b"out"})
    (tank / "escaping.csp").write_text(LOOP.format(fmu="escaping.fmu"))
    assert main(["run", str(tank / "escaping.csp"), "--environment", "AsFmu", *options]) == 1
    assert "a file that leads outside of its folder: ../../escaped.txt" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("data", "reported"),
    [
        (b"hello", "is no FMU: it is no archive"),
        (None, "cannot be read: No such file"),
        (b'<fmiModelDescription fmiVersion="1.0"/>', "is an FMU for FMI 1.0"),
        (b"<fmiModelDescription", "has a damaged modelDescription.xml"),
        (b'<fmiModelDescription fmiVersion="2.0"/>', "has a modelDescription.xml that lacks"),
        (
            b'<fmiModelDescription fmiVersion="2.0" modelName="x" guid="y" numberOfEventIndicators="many"/>',
            "has a modelDescription.xml with a wrong number: invalid literal for int() with base 10: 'many'",
        ),
    ],
)
def test_what_is_no_fmu_is_a_diagnostic(
    tank: Path, data: bytes | None, reported: str, capsys: pytest.CaptureFixture[str]
) -> None:
    place = tank / "damaged.fmu"
    place.unlink(missing_ok=True)
    if data is not None and data.startswith(b"<"):
        with zipfile.ZipFile(place, "w") as archive:
            archive.writestr("modelDescription.xml", data)
    elif data is not None:
        place.write_bytes(data)
    (tank / "damaged.csp").write_text(LOOP.format(fmu="damaged.fmu"))
    assert main(["check", str(tank / "damaged.csp")]) == 1
    shown = "".join(capsys.readouterr())
    assert f"error[E0840]: {place} {reported}" in shown
    assert shown.endswith("1 error\n"), "ports that nobody knows are not reported"


@pytest.mark.parametrize(
    ("ports", "reported"),
    [
        ("in opening : double  out level : double<mm>", "`level` has the unit mm here, and m in the FMU"),
        ("in opening : double  out level : double<rad>", "`level` has the unit rad here, and m in the FMU"),
        ("in opening : double  out lever : double<m>", "the FMU has no output `lever`"),
        ("in opening : int  out level : double<m>", "`opening` is a int here, and in the FMU a double"),
        ("in level : double<m>", "the FMU has no input `level`"),
    ],
)
def test_ports_that_do_not_fit(tank: Path, ports: str, reported: str, capsys: pytest.CaptureFixture[str]) -> None:
    (tank / "ports.csp").write_text(f'submodel Plant fmu "tank_bench.fmu" {{ {ports} }}\n')
    assert main(["check", str(tank / "ports.csp")]) == 1
    shown = capsys.readouterr()
    assert reported in shown.out + shown.err


def test_a_unit_whose_name_is_that_of_another_is_shown_by_its_dimension(
    tank: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with zipfile.ZipFile(tank / "tank_bench.fmu") as archive:
        description = archive.read("modelDescription.xml")
    assert b'<BaseUnit m="1"' in description
    description = description.replace(b'<BaseUnit m="1"', b'<BaseUnit kg="1"')
    damaged(
        tank, "kilograms", lambda name: None if name == "modelDescription.xml" else name,
        **{"modelDescription.xml": description},
    )  # fmt: skip
    (tank / "ports.csp").write_text(
        'submodel Plant fmu "kilograms.fmu" { in opening : double  out level : double<m> }\n'
    )
    assert main(["check", str(tank / "ports.csp")]) == 1
    assert "`level` has the unit m here, and kg in the FMU" in "".join(capsys.readouterr())


def test_an_error_at_a_step_ends_the_run_with_its_text_and_safe_values(
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
    for options in TARGETS:
        capsys.readouterr()
        trace = tmp_path / "trace.jsonl"
        assert main(["run", str(tmp_path / "watch.csp"), "--for", "1 s", "--trace", str(trace), *options]) == 1
        shown = capsys.readouterr()
        assert "ended unsuccessfully at 18 ms" in shown.out + shown.err
        assert "desk.fmu returned an error in fmi2DoStep" in shown.out + shown.err
        assert "Fault: division by zero, in Desk (desk.csp:" in shown.out + shown.err
