"""A loaded program in a notebook."""

from __future__ import annotations

from pathlib import Path

import pytest

import cspdiag
from cspdiag.draw.layout import engine
from cspdiag.draw.layout.elk import engine_available
from cspdiag.draw.missing import missing

needs_engine = pytest.mark.skipif(not engine_available(), reason="the layout engine was not fetched (make setup)")

MODEL = Path(__file__).parents[2] / "models/commstime/commstime.csp"


@needs_engine
def test_a_program_shows_its_diagrams_with_the_outermost_process_unfolded() -> None:
    shown = cspdiag.load(MODEL)._repr_html_()
    assert shown is not None
    assert shown.startswith("<details open><summary>Commstime</summary>")
    assert shown.count("<details") == shown.count("<svg") == 5


@needs_engine
def test_a_program_with_errors_shows_them_and_what_can_be_read(tmp_path: Path) -> None:
    program = tmp_path / "broken.csp"
    program.write_text(MODEL.read_text().replace("prefix.output", "prefix.outlet"))
    shown = cspdiag.load(program)._repr_html_()
    assert shown is not None
    assert shown.startswith("<pre>error[")
    assert "<details open><summary>Commstime</summary>" in shown


def test_without_an_engine_a_program_shows_its_name(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(_: object) -> None:
        raise missing("quickjs-ng")

    monkeypatch.setattr(engine, "run", fails)
    assert cspdiag.load(MODEL)._repr_html_() is None
