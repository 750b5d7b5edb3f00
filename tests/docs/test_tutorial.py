"""Every program of the tutorial does what the text says."""

from __future__ import annotations

from pathlib import Path

import pytest

import cspdiag
from cspdiag.base import SourceFile
from cspdiag.base.report import Report
from cspdiag.cli.main import main
from cspdiag.simulate.result import Run
from cspdiag.syntax.format.formatter import format_tree
from cspdiag.syntax.parser import parse
from tests.literate import Block, cases_of

TUTORIAL = Path(__file__).parents[2] / "docs" / "tutorial.md"


def blocks() -> list[Block]:
    return [block for case in cases_of(TUTORIAL) for block in case.blocks]


def program(name: str) -> str:
    (text,) = [block.text for block in blocks() if block.language == "csp" and block.name == name]
    return text


def run(folder: Path, name: str, until: str | None = None, set: dict[str, str] | None = None) -> Run:
    path = folder / "axis.csp"
    path.write_text(program(name), encoding="utf-8")
    return cspdiag.load(path).run(until=until, set=set or {})


@pytest.mark.parametrize(
    "name", [block.name for block in blocks() if block.language == "csp" and block.name != "fmu/model.csp"]
)
def test_the_compiler_reports_what_the_text_shows(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    found = blocks()
    (place,) = [k for k, block in enumerate(found) if block.language == "csp" and block.name == name]
    following = found[place + 1] if place + 1 < len(found) else None
    shown = following.text if following is not None and following.language == "text" else None
    monkeypatch.chdir(tmp_path)
    Path("axis.csp").write_text(program(name), encoding="utf-8")
    code = main(["check", "axis.csp"])
    assert "".join(capsys.readouterr()) == (shown or "checked 1 file: no errors\n")
    assert code == (shown is not None)


def test_the_mistake_is_shown_where_it_is_in_the_whole_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    correct = "kp: double<V/m> = 15<V/m>"
    whole = program("first/axis.csp")
    assert whole.count(correct) == 1
    monkeypatch.chdir(tmp_path)
    Path("axis.csp").write_text(whole.replace(correct, "kp: double = 15"), encoding="utf-8")
    main(["check", "axis.csp"])
    assert "".join(capsys.readouterr()) in [block.text for block in blocks() if block.language == "text"]


@pytest.mark.parametrize("name", [block.name for block in blocks() if block.language == "csp"])
def test_program_is_in_the_standard_format(name: str) -> None:
    tree = parse(SourceFile(name="axis.csp", text=program(name)), Report())
    assert tree is not None
    assert format_tree(tree) == program(name)


def test_first_program_reaches_its_set_point(tmp_path: Path) -> None:
    result = run(tmp_path, "first/axis.csp", until="3 s")
    assert result.outcome.ended == "time limit"
    assert result["position"][-1] == pytest.approx(0.2, abs=0.002)
    assert result["control"][-1] == 0


def test_two_modes_find_the_switch_and_follow(tmp_path: Path) -> None:
    result = run(tmp_path, "modes/axis.csp")
    assert result.outcome.ended == "terminated"
    assert result.outcome.time == 8_000_000_000
    assert result["position"][-1] == pytest.approx(0.3 - 0.25, abs=0.003)
    assert result["control"][-1] == 0


def test_the_axis_behaves_the_same_with_a_plant_that_is_an_fmu(tmp_path: Path) -> None:
    pytest.importorskip("fmpy")
    builder = pytest.importorskip("pythonfmu.builder")
    (shown,) = [block.text for block in blocks() if block.name == "examples/fmu/slide.py"]
    script = TUTORIAL.parents[1] / "examples" / "fmu" / "slide.py"
    assert shown == script.read_text(encoding="utf-8")
    builder.FmuBuilder.build_FMU(str(script), dest=str(tmp_path))
    expected = run(tmp_path, "modes/axis.csp")
    (tmp_path / "model.csp").write_text(program("fmu/model.csp"), encoding="utf-8")
    result = cspdiag.load(tmp_path / "model.csp").run("Modelled")
    assert (result.outcome.ended, result.outcome.time) == ("terminated", 8_000_000_000)
    assert result["position"] == pytest.approx(expected["position"], abs=0.002)
    nearer = cspdiag.load(tmp_path / "model.csp").run("Modelled", set={"slide.start": "0.1"})
    assert 0 < nearer["closed"].argmax() < result["closed"].argmax()


def test_both_modes_report_a_slow_period(tmp_path: Path) -> None:
    def worst(period: str) -> float:
        result = run(tmp_path, "modes/axis.csp", set={"T": period})
        late = (result.time("position") > 7) & (result.time("position") < 8)
        return float(abs(result["position"][late] - result["position"][late].mean()).max())

    assert worst("10 ms") < 0.001
    assert worst("200 ms") > 0.01
