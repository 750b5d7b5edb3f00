"""Drawings of all models as a browser shows them, at three sizes: nothing covers words, and all words are on
the sheet.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from cspdiag.base.sources import read_source
from cspdiag.draw.layout.elk import engine_available
from cspdiag.draw.output.svg import render_svg
from cspdiag.draw.pictures import Pictures
from cspdiag.draw.scene.geometry import Point
from cspdiag.draw.scene.scene_geometry import fitted
from cspdiag.draw.scene.shapes import Group, Line, Text, TextRun
from cspdiag.pipeline import check
from tests.draw.geometry.browser import BROWSER, answer

ROOT = Path(__file__).parents[3]
MODELS = sorted(path.relative_to(ROOT).as_posix() for path in ROOT.glob("models/*/*.csp"))
SIZES = (0.5, 1, 2.5)

pytestmark = [
    pytest.mark.skipif(BROWSER is None, reason="Chromium is not installed"),
    pytest.mark.skipif(not engine_available(), reason="the layout engine was not fetched (make setup)"),
]


def page(drawings: dict[str, str]) -> str:
    """A page that shows drawings in all sizes and measures them."""
    script = (Path(__file__).parent / "measure.js").read_text()
    figures = "".join(
        f'<figure id="{name} at {size}" style="zoom: {size}">{drawing}</figure>\n'
        for name, drawing in drawings.items()
        for size in SIZES
    )
    return f"<!doctype html><meta charset=utf-8>\n{figures}<script>{script}</script>"


def drawings() -> dict[str, str]:
    found = {}
    for model in MODELS:
        checked = check(read_source(str(ROOT / model)), read_source)
        assert checked.readable is not None
        pictures = Pictures(checked.readable)
        for definition in pictures.drawn():
            found[f"{model} {definition.name.text}"] = render_svg(pictures.scene(definition))
    return found


@pytest.mark.slow
def test_nothing_overlaps_in_a_browser(tmp_path: Path) -> None:
    drawn = drawings()
    measured = answer(tmp_path, page(drawn))
    assert len(measured) == len(SIZES) * len(drawn)
    assert all(each["words"] > 1 and each["shapes"] > 1 for each in measured.values())
    widths = {
        size: sum(each["width"] for name, each in measured.items() if name.endswith(f"at {size}")) for size in SIZES
    }
    assert widths[0.5] * 4 < widths[1] * 2.5 < widths[2.5] * 1.2
    assert {name: each["faults"] for name, each in measured.items() if each["faults"]} == {}


def test_the_measurement_sees_what_lies_on_words(tmp_path: Path) -> None:
    def drawing(height: float) -> str:
        words = Text(Point(50, 50), (TextRun("words"),))
        return render_svg(fitted((Group("line", (words, Line((Point(0, height), Point(200, height))))),)))

    measured = answer(tmp_path, page({"through": drawing(46), "beside": drawing(56)}))
    assert measured["through at 1"]["faults"] == ["a line runs through words"]
    assert measured["beside at 1"]["faults"] == []
