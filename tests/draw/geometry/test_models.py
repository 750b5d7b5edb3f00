"""Drawings of all models: nothing overlaps, in all styles of drawing."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings

from cspdiag.base import SourceFile
from cspdiag.base.sources import read_source
from cspdiag.draw.layout.elk import engine_available
from cspdiag.draw.pictures import PictureOptions, Pictures
from cspdiag.draw.scene.geometry import Point, Rectangle
from cspdiag.draw.scene.scene_geometry import fitted
from cspdiag.draw.scene.shapes import Box, Line, Scene, Text, TextRun
from cspdiag.pipeline import check
from tests.draw.geometry.rules import faults
from tests.properties.programs import programs

ROOT = Path(__file__).parents[3]
MODELS = sorted(path.relative_to(ROOT).as_posix() for path in ROOT.glob("models/*/*.csp"))

needs_engine = pytest.mark.skipif(not engine_available(), reason="the layout engine was not fetched (make setup)")


def pictures_of(model: str) -> Pictures:
    checked = check(read_source(str(ROOT / model)), read_source)
    assert checked.readable is not None
    return Pictures(checked.readable)


@needs_engine
@pytest.mark.parametrize("model", MODELS)
def test_nothing_overlaps(model: str) -> None:
    pictures = pictures_of(model)
    for definition in pictures.drawn():
        assert faults(pictures.scene(definition)) == [], definition.name.text


@needs_engine
@pytest.mark.parametrize("depth", [2, 3])
def test_nothing_overlaps_inside_boxes(depth: int) -> None:
    pictures = pictures_of("models/jiwy/jiwy.csp")
    jiwy = pictures.outermost()
    assert jiwy is not None
    assert faults(pictures.scene(jiwy, PictureOptions(which="communication", depth=depth))) == []


WORDS = Text(Point(50, 50), (TextRun("words"),))


@pytest.mark.parametrize(
    ("other", "fault"),
    [
        (Line((Point(0, 46), Point(200, 46))), "runs through 'words'"),
        (Line((Point(60, 0), Point(60, 200))), "runs through 'words'"),
        (Box(Rectangle(60, 0, 100, 100), fill=None), "runs through 'words'"),
        (Text(Point(70, 55), (TextRun("others"),)), "'words' lies on 'others'"),
        (Box(Rectangle(0, 0, 100, 100), stroke=None), "'words' is covered"),
    ],
)
def test_the_rules_see_what_lies_on_words(other: Line | Box | Text, fault: str) -> None:
    assert any(fault in each for each in faults(fitted((WORDS, other))))


def test_words_in_a_box_and_next_to_a_line_are_accepted() -> None:
    beside = Line((Point(0, 54), Point(200, 54)))
    assert faults(fitted((Box(Rectangle(20, 20, 150, 80)), WORDS, beside))) == []


def test_the_rules_detect_what_leaves_the_sheet() -> None:
    assert any("leaves the sheet" in each for each in faults(Scene(60, 60, (WORDS,))))


@needs_engine
@settings(max_examples=2, deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=True)
@given(programs())
def test_nothing_overlaps_in_random_programs(text: str) -> None:
    checked = check(SourceFile(name="drawn.csp", text=text), read_source)
    assert checked.readable is not None
    pictures = Pictures(checked.readable)
    for definition in pictures.drawn():
        for depth in (1, 2):
            scene = pictures.scene(definition, PictureOptions(which="communication", depth=depth))
            assert faults(scene) == [], definition.name.text
