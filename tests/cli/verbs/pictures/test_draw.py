"""``cspdiag draw``."""

from __future__ import annotations

import os
from pathlib import Path
from xml.etree import ElementTree

import pytest

from cspdiag.draw.layout.elk import engine_available
from tests.cli.conftest import Command

ROOT = Path(__file__).parents[4]
JIWY = ROOT / "models/jiwy/jiwy.csp"

needs_engine = pytest.mark.skipif(
    not engine_available(), reason="the layout engine is not there: make setup fetches it"
)


def texts(svg: str) -> str:
    return " ".join(
        "".join(element.itertext()) for element in ElementTree.fromstring(svg).iter() if "text" in element.tag
    )


@needs_engine
def test_the_outermost_process_is_drawn_into_a_file_of_its_name(
    cspdiag: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert cspdiag("draw", JIWY) == (0, "", "wrote Jiwy.svg\n")
    drawn = texts((tmp_path / "Jiwy.svg").read_text())
    assert "horizontal: JointControl" in drawn
    assert "composition of Jiwy" in drawn
    assert os.listdir(tmp_path) == ["Jiwy.svg"]


@needs_engine
def test_one_diagram_of_one_process_is_written_to_the_requested_file(cspdiag: Command, good: Path) -> None:
    out = good.with_name("the relay.svg")
    result = cspdiag("draw", good, "--process", "Relay", "--diagram", "communication", "-o", out)
    assert (result.code, result.err) == (0, f"wrote {out}\n")
    assert "composition" not in texts(out.read_text())
    assert "held: int = 0" in texts(out.read_text())


@needs_engine
@pytest.mark.parametrize(("name", "begins"), [("x.svg", b"<svg"), ("x.png", b"\x89PNG"), ("x.pdf", b"%PDF")])
def test_the_name_of_the_output_decides_its_format(cspdiag: Command, good: Path, name: str, begins: bytes) -> None:
    out = good.with_name(name)
    assert cspdiag("draw", good, "-o", out).code == 0
    assert begins in out.read_bytes()[:200]


@needs_engine
def test_standard_output_takes_an_svg(cspdiag: Command, good: Path) -> None:
    result = cspdiag("draw", good, "-o", "-")
    assert (result.code, result.err) == (0, "")
    assert "given: int" in texts(result.out)


@needs_engine
def test_standard_input_is_drawn_too(cspdiag: Command, good: Path) -> None:
    assert "given: int" in texts(cspdiag("draw", "-", "-o", "-", stdin=good.read_text()).out)


@needs_engine
def test_all_pictures_go_into_a_folder(cspdiag: Command, tmp_path: Path) -> None:
    result = cspdiag("draw", JIWY, "--all", "-o", tmp_path / "my diagrams", "--diagram", "communication")
    assert (result.code, result.err) == (0, f"wrote 8 pictures to {tmp_path / 'my diagrams'}\n")
    assert {path.name for path in (tmp_path / "my diagrams").iterdir()} == {
        f"{name}.svg"
        for name in ("Align", "MotionControl", "Homing", "JointControl", "Jiwy", "Bench", "Worn", "Gamepad")
    }


@needs_engine
def test_all_pictures_go_into_one_below_each_other(cspdiag: Command, tmp_path: Path) -> None:
    path, single = tmp_path / "all.svg", tmp_path / "one.svg"
    assert cspdiag("draw", JIWY, "--all", "-o", path, "--diagram", "communication").code == 0
    assert cspdiag("draw", JIWY, "--process", "Align", "-o", single, "--diagram", "communication").code == 0
    drawn, alone = path.read_text(), single.read_text()
    names = ["Align", "MotionControl", "Homing", "JointControl", "Jiwy", "Bench", "Worn", "Gamepad"]
    assert f"<title>{', '.join(names)}</title>" in drawn
    assert "<desc>" not in drawn
    assert "<desc>" in alone
    assert set(texts(alone)) < set(texts(drawn))


@needs_engine
def test_labels_are_hidden_by_name(cspdiag: Command, good: Path) -> None:
    result = cspdiag("draw", good, "-o", "-", "--diagram", "communication", "--hide-labels=types")
    assert "int" not in texts(result.out)
    refused = cspdiag("draw", good, "-o", "-", "--hide-labels=nothing")
    assert refused == (2, "", "cspdiag: --hide-labels: there is no label `nothing` in what is drawn\n")


@needs_engine
def test_a_file_may_follow_the_option_to_hide_all_labels(cspdiag: Command, good: Path) -> None:
    hidden = cspdiag("draw", "-o", "-", "--diagram", "communication", "--hide-labels", good)
    assert hidden == cspdiag("draw", good, "-o", "-", "--diagram", "communication", "--hide-labels")
    assert hidden.code == 0
    assert cspdiag("draw", "--hide-labels", "types").code == 2
    assert cspdiag("draw").code == 2


def test_a_program_with_errors_is_not_drawn(cspdiag: Command, bad: Path) -> None:
    result = cspdiag("draw", bad, "-o", bad.with_name("x.svg"))
    assert result.code == 1
    assert "1 error" in result.err
    assert not bad.with_name("x.svg").exists()


@needs_engine
def test_a_program_with_errors_is_drawn_with_them_on_demand(cspdiag: Command, bad: Path) -> None:
    out = bad.with_name("x.svg")
    result = cspdiag("draw", bad, "--check", "-o", out)
    assert result.code == 1
    assert "there is no value" in result.err or "error" in result.err
    document = ElementTree.fromstring(out.read_text())
    badges = [element for element in document.iter() if "badge" in element.get("class", "")]
    assert badges
    assert "E0" in texts(out.read_text())


@needs_engine
def test_check_draws_every_process_with_a_diagnostic(cspdiag: Command, tmp_path: Path) -> None:
    path = tmp_path / "two.csp"
    path.write_text(
        "process A { out x : int  composition { x ! true } }\n"
        "process B { out x : int  composition { x ! false } }\n"
        "process C { out x : int  composition { x ! 1 } }\n"
    )
    shown = texts(_drawn(cspdiag, path))
    assert "process A" in shown
    assert "process B" in shown
    assert "process C" not in shown


def _drawn(cspdiag: Command, path: Path) -> str:
    result = cspdiag("draw", path, "--check", "-o", "-")
    assert result.code == 1
    return result.out


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["-o", "x.gif"], "must end in .svg, .png, .pdf, .dot, .mmd or .graphml,"),
        (["-o", "nowhere/x.svg"], "there is no folder nowhere"),
        (["-o", "x.svg", "--format", "pdf"], "contradicts"),
        (["--process", "Jiwi"], "did you mean `Jiwy`?"),
        (["--book", "x.svg"], "--book x.svg: the name must end in .html"),
        (["--book", "x"], "--book x: the name must end in .html"),
        (["--depth", "0"], "--depth is at least 1"),
        (["--depth", "1.5"], "argument --depth: expected a whole number, not '1.5'"),
        (["--depth", "1" * 5000], "argument --depth: expected a whole number"),
        (["--scale", "1000"], "--scale is between"),
        (["--scale", "nan"], "argument --scale: expected a finite number, not 'nan'"),
    ],
)
def test_requests_that_cannot_be_drawn_are_refused_in_one_line(
    cspdiag: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], says: str
) -> None:
    monkeypatch.chdir(tmp_path)
    result = cspdiag("draw", JIWY, *arguments)
    assert (result.code, result.out) == (2, "")
    assert says in result.err
    assert result.err.count("\n") == 1
    assert os.listdir(tmp_path) == []


def test_a_file_without_processes_has_no_picture(cspdiag: Command, tmp_path: Path) -> None:
    path = tmp_path / "constants.csp"
    path.write_text("const n = 1\n")
    result = cspdiag("draw", path)
    assert (result.code, result.err) == (1, f"cspdiag: {path} has no process to draw\n")


@needs_engine
@pytest.mark.parametrize("options", [["--process", "Relay"], ["--all", "-o", "pictures"]], ids=["file", "folder"])
def test_a_picture_that_is_named_by_the_program_is_not_drawn_through_a_link(
    cspdiag: Command, good: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, options: list[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "other").write_text("of another program\n")
    (tmp_path / "pictures").mkdir()
    for folder in (tmp_path, tmp_path / "pictures"):
        (folder / "Relay.svg").symlink_to(tmp_path / "other")
    done = cspdiag("draw", good, *options)
    assert done.code == 2
    assert "symbolic link" in done.err
    assert (tmp_path / "other").read_text() == "of another program\n"
