"""Damaged programs are drawn and compared as far as they can be parsed."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from cspdiag.base import SourceFile
from cspdiag.base.sources import read_source
from cspdiag.draw.differences.picture import pictures_of
from cspdiag.draw.differences.programs import differences
from cspdiag.draw.differences.render_json import render as render_json
from cspdiag.draw.differences.render_text import render
from cspdiag.draw.elements.listing import listing
from cspdiag.draw.layout.elk import engine_available
from cspdiag.draw.output.svg import render_svg
from cspdiag.draw.pictures import PictureOptions, Pictures
from cspdiag.pipeline import check
from tests.draw.geometry.rules import faults
from tests.robustness.damage import ROOT, damaged


def pictures(path: Path, text: str) -> Pictures | None:
    checked = check(SourceFile(name=str(path), text=text), read_source)
    return None if checked.readable is None else Pictures(checked.readable, checked.report.diagnostics)


@pytest.mark.parametrize("seed", range(25))
def test_elements_and_differences_are_found(seed: int) -> None:
    path, text = damaged(seed)
    found = pictures(path, text)
    if found is None:
        return
    for definition in found.drawn(imported=True):
        assert listing(found.communication(definition, 2)).startswith(f"communication of {definition.name.text}")
    whole = pictures(path, path.read_text(encoding="utf-8"))
    assert whole is not None
    there, back = differences(whole.program, found.program), differences(found.program, whole.program)
    assert len(render(there.changes)) > 0 or not there.changes
    assert bool(there.changes) == bool(back.changes)
    assert render_json(there.changes)


@pytest.mark.skipif(not engine_available(), reason="the layout engine is not there: make setup fetches it")
@pytest.mark.parametrize("seed", range(6))
def test_pictures_with_marks_are_drawn(seed: int) -> None:
    found = pictures(*damaged(seed))
    for definition in [] if found is None else found.drawn()[-2:]:
        assert found is not None
        assert render_svg(found.scene(definition, PictureOptions())).startswith("<")


PROGRAM = re.compile(r"^```csp\n(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL)
MISTAKES = [
    (path, match["text"])
    for path in sorted(ROOT.glob("tests/cases/[mn]*/*.md"))
    for match in PROGRAM.finditer(path.read_text(encoding="utf-8"))
]


@pytest.mark.skipif(not engine_available(), reason="the layout engine is not there: make setup fetches it")
@pytest.mark.parametrize("start", range(6))
def test_marked_mistakes_overlap_nothing(start: int) -> None:
    assert len(MISTAKES) > 150
    for path, text in MISTAKES[start::6]:
        found = pictures(path, text)
        for definition in [] if found is None else found.drawn():
            assert found is not None
            if found.concerned(definition):
                assert faults(found.scene(definition)) == [], f"{path.name} {definition.name.text}"


@pytest.mark.skipif(not engine_available(), reason="the layout engine is not there: make setup fetches it")
@pytest.mark.parametrize("seed", range(6))
def test_nothing_overlaps_in_pictures_of_differences(seed: int) -> None:
    path, text = damaged(seed)
    one, other = pictures(path, path.read_text(encoding="utf-8")), pictures(path, text)
    if one is not None and other is not None:
        for scene in pictures_of(differences(one.program, other.program))[:3]:
            assert faults(scene) == []
