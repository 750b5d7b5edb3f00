"""Drawing from Python, as in a notebook."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import pytest

import cspdiag
from cspdiag.api import ProgramError
from cspdiag.draw.layout.elk import engine_available

ROOT = Path(__file__).parents[2]
JIWY = ROOT / "models/jiwy/jiwy.csp"
WRONG = "process P { in a : int  out b : double  communication { var v : int }  composition { mu (a ? v ; b ! v) } }\n"

needs_engine = pytest.mark.skipif(
    not engine_available(), reason="the layout engine is not there: make setup fetches it"
)


@pytest.fixture
def wrong(tmp_path: Path) -> Path:
    path = tmp_path / "wrong.csp"
    path.write_text(WRONG)
    return path


@needs_engine
def test_a_notebook_shows_the_outermost_process_or_the_requested_one() -> None:
    program = cspdiag.load(JIWY)
    assert "horizontal" in ElementTree.tostring(ElementTree.fromstring(program.draw()._repr_svg_()), encoding="unicode")
    assert repr(program.draw("Bench")) == "<Drawing of Bench>"


@needs_engine
def test_labels_are_hidden_all_or_by_name() -> None:
    program = cspdiag.load(JIWY)

    def drawn(hide: bool | list[str]) -> str:
        return program.draw("JointControl", diagram="communication", hide_labels=hide).svg()

    def shown(svg: str) -> set[str]:
        return {element.text or "" for element in ElementTree.fromstring(svg).iter() if element.tag.endswith("tspan")}

    assert "leftmax" in shown(drawn(False))
    assert shown(drawn(True)) & {"leftmax", ": double<rad>"} == set()
    assert ": double<rad>" not in shown(drawn(["types"]))


@needs_engine
def test_a_drawing_is_saved_in_the_format_of_its_name(tmp_path: Path) -> None:
    drawing = cspdiag.load(JIWY).draw("Align", diagram="communication")
    for name, begins in (("a.svg", b"<svg"), ("a.png", b"\x89PNG"), ("a.pdf", b"%PDF")):
        drawing.save(tmp_path / name)
        assert begins in (tmp_path / name).read_bytes()[:300]
    with pytest.raises(ValueError, match="svg, png, pdf"):
        drawing.save(tmp_path / "a.gif")
    assert not (tmp_path / "a.gif").exists()


@needs_engine
def test_a_program_with_errors_is_drawn_only_with_its_errors(wrong: Path) -> None:
    program = cspdiag.load(wrong)
    with pytest.raises(ProgramError):
        program.draw()
    assert "badge error" in program.draw(check=True).svg()


def test_missing_parts_are_not_drawn(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"`Jiwi` .did you mean `Jiwy`"):
        cspdiag.load(JIWY).draw("Jiwi")
    empty = tmp_path / "empty.csp"
    empty.write_text("const n = 1\n")
    with pytest.raises(ValueError, match="no process"):
        cspdiag.load(empty).draw()
