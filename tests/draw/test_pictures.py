"""The pictures in the documentation are what the tool draws now."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from cspdiag.draw.layout.elk import engine_available
from distribution.model_pictures import FOLDER, PICTURES, pictures

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted(ROOT.glob("docs/*.md")), *sorted(ROOT.glob("models/*/README.md"))]


@pytest.mark.skipif(not engine_available(), reason="the layout engine is not there: make setup fetches it")
def test_the_pictures_are_current() -> None:
    drawn = dict(pictures())
    assert len(drawn) == len(PICTURES)
    stale = [path.name for path, text in drawn.items() if path.read_text(encoding="utf-8") != text]
    assert stale == [], "make pictures"


def test_every_picture_is_shown_somewhere_and_what_is_shown_exists() -> None:
    shown = {
        (page.parent / target).resolve()
        for page in PAGES
        for target in re.findall(r"!\[[^\]]*\]\(([^)\s]+\.svg)\)", page.read_text(encoding="utf-8"))
        if "://" not in target
    }
    assert [path for path in shown if not path.is_file()] == []
    assert {(FOLDER / f"{name}.svg").resolve() for name in PICTURES} <= shown
