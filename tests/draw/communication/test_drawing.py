"""Drawn communication diagrams: everything is shown, can be distinguished without colour, and can be hidden
or marked.
"""

from __future__ import annotations

import random
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import get_args

import pytest

from cspdiag.base import SourceFile
from cspdiag.base.sources import read_source
from cspdiag.draw.communication import symbols
from cspdiag.draw.communication.diagram import draw_communication
from cspdiag.draw.composition.diagram import draw_composition
from cspdiag.draw.elements.diagram import Box as InstanceBox
from cspdiag.draw.elements.diagram import BoxKind, CommunicationDiagram, Store
from cspdiag.draw.elements.marks import Mark, MarkKind
from cspdiag.draw.hiding import ALL_LABELS, NOTHING_HIDDEN, Hidden
from cspdiag.draw.layout.elk import engine_available
from cspdiag.draw.pictures import PictureOptions, Pictures, places_of
from cspdiag.draw.scene.geometry import Point, Rectangle
from cspdiag.draw.scene.scene_geometry import every
from cspdiag.draw.scene.shapes import Box, Dash, Ellipse, Group, Ink, Item, Line, Scene, Text
from cspdiag.pipeline import check
from tests.draw.geometry.rules import faults

ROOT = Path(__file__).parents[3]
JIWY = str(ROOT / "models/jiwy/jiwy.csp")

pytestmark = pytest.mark.skipif(not engine_available(), reason="the layout engine is not there: make setup fetches it")


def pictures(name: str) -> Pictures:
    checked = check(read_source(str(ROOT / "models" / name)), read_source)
    assert checked.program is not None
    return Pictures(checked.program)


def diagram(name: str, definition: str, depth: int = 1) -> CommunicationDiagram:
    found = pictures(name)
    drawn = found.named(definition)
    assert drawn is not None
    return found.communication(drawn, depth)


@pytest.fixture(scope="module")
def joint() -> CommunicationDiagram:
    return diagram("jiwy/jiwy.csp", "JointControl")


def words(scene: Scene) -> list[str]:
    return ["".join(run.text for run in item.runs) for item in every(scene.items) if isinstance(item, Text)]


def groups(scene: Scene) -> dict[str, Group]:
    return {item.id: item for item in every(scene.items) if isinstance(item, Group) and item.id}


def test_every_element_is_a_group_with_its_name_and_what_it_is(joint: CommunicationDiagram) -> None:
    found = groups(draw_communication(joint))
    assert {element.key for element in joint.elements()} <= found.keys()
    assert found["alignL"].kind == "instance process"
    assert found["leftmax"].kind == "channel var"
    assert found["leftmax"].title.splitlines()[:3] == [
        "leftmax : double<rad>",
        "alignL.max → motionControl.leftmax, homing.leftmax",
        "variable",
    ]
    assert "Turns one joint at constant speed" in found["alignL"].title
    assert re.search(r"jiwy\.csp:\d+$", found["alignL"].title)


def test_boxes_ports_and_arrows_carry_the_texts_of_the_paper(joint: CommunicationDiagram) -> None:
    shown = words(draw_communication(joint))
    assert "alignL: Align" in shown
    assert "leftmax: double<rad>" in shown
    assert "feedback: double<rad> @T" in shown
    assert shown.count("feedback") == 4


def test_labels_are_hidden_all_or_one_by_one(joint: CommunicationDiagram) -> None:
    assert "rightmax: double<rad>" in words(draw_communication(joint, hidden=Hidden(frozenset({"leftmax"}))))
    assert not [
        text for text in words(draw_communication(joint, hidden=Hidden(frozenset({"types"})))) if "double" in text
    ]
    bare = words(draw_communication(joint, hidden=ALL_LABELS))
    assert "feedback" in bare
    assert not [text for text in bare if text.startswith(("leftmax", "rightmax"))]
    labelled = groups(draw_communication(joint, hidden=Hidden(frozenset({"leftmax"}))))
    assert not [item for item in labelled["leftmax"].items if isinstance(item, Text) and "leftmax" in item.runs[0].text]
    assert [item for item in labelled["rightmax"].items if isinstance(item, Text) and "rightmax" in item.runs[0].text]


def outline(items: tuple[Item, ...]) -> tuple[object, ...]:
    """What remains of shapes in black and white."""

    def parts() -> Iterator[object]:
        for item in items:
            match item:
                case Box(place=place, radius=radius, dash=dash, fill=fill):
                    yield "box", place, radius, dash, fill is Ink.PAPER
                case Ellipse(place=place, fill=fill):
                    yield "ellipse", place, fill is Ink.PAPER
                case Line(points=points, dash=dash, fill=fill):
                    yield "line", points, dash, fill is Ink.PAPER

    return tuple(parts())


def test_instances_and_variables_differ_in_shape_not_only_in_colour() -> None:
    place = Rectangle(0, 0, 100, 50)
    kinds: tuple[BoxKind, ...] = ("process", "submodel", "driver", "unknown")
    shapes = [outline(symbols.instance(InstanceBox(key="x", kind=kind, definition="X"), place)) for kind in kinds]
    shapes.append(outline(symbols.instance(InstanceBox(key="x", kind="process", definition="X", language="c"), place)))
    shapes.append(outline(symbols.instance(InstanceBox(key="x", kind="process", definition="X", size="8"), place)))
    shapes.append(outline(symbols.store(Store(key="x", form="variable", type="int"), place)))
    shapes.append(outline(symbols.store(Store(key="x", form="channel", type="int"), place)))
    assert len(set(shapes)) == len(shapes)


def test_kinds_of_channels_differ_in_the_shape_of_their_symbols() -> None:
    without = {"constant", "discard"}
    kinds = [kind for alias in get_args(symbols.Symbol) for kind in get_args(alias) if kind not in without]
    shapes = [outline(symbols.kind_symbol(kind, Point(0, 0), Point(60, 0))) for kind in kinds]
    assert len(shapes) == 9
    assert len(set(shapes)) == len(shapes)


def test_the_legend_explains_what_occurs_and_nothing_else(joint: CommunicationDiagram) -> None:
    (legend,) = [item for item in draw_communication(joint).items if isinstance(item, Group) and item.kind == "legend"]
    explained = [item.runs[0].text for item in legend.items if isinstance(item, Text)]
    assert explained == [
        "process",
        "variable: the last value written",
        "sampled at the period @",
        "event from or to the environment",
    ]


MARKED = ["dining/dining.csp", "emergency/emergency.csp", "buffer/buffer.csp", "jiwy/jiwy.csp"]


def random_marks(generator: random.Random, keys: Iterable[str]) -> dict[str, Mark]:
    """Marks of all kinds on a fifth, half or all of the elements, with up to five messages each."""
    share = generator.choice((0.2, 0.5, 1))
    return {
        key: Mark(
            generator.choice(get_args(MarkKind)), tuple(sorted(generator.sample(range(1, 40), generator.randint(1, 5))))
        )
        for key in keys
        if generator.random() < share
    }


@pytest.mark.parametrize("name", MARKED)
def test_badges_overlap_nothing_however_many_there_are(name: str) -> None:
    generator = random.Random(name)
    found = pictures(name)
    for definition in found.drawn():
        shown = found.communication(definition, generator.choice((1, 2)))
        scene = draw_communication(shown, marks=random_marks(generator, places_of(shown)))
        assert faults(scene) == [], definition.name.text
        composed = found.composition(definition)
        for _ in range(0 if composed is None else 4):
            assert composed is not None
            marks = random_marks(generator, [element.key for element in composed.elements()])
            assert faults(draw_composition(composed, marks=marks)) == [], definition.name.text


@pytest.mark.parametrize(("kind", "sign"), [("error", "!"), ("added", "+"), ("removed", "−"), ("changed", "Δ")])  # noqa: RUF001
def test_marks_have_a_sign_besides_their_colour(joint: CommunicationDiagram, kind: MarkKind, sign: str) -> None:
    mark = Mark(kind, note="because of this")
    scene = draw_communication(joint, marks={"homing": mark, "leftmax": mark, "feedback": mark})
    badges = [item for item in every(scene.items) if isinstance(item, Group) and item.kind.startswith("badge")]
    assert len(badges) == 3
    assert words(scene).count(sign) == 3
    found = groups(scene)
    assert all("because of this" in found[key].title for key in ("homing", "leftmax", "feedback"))
    if kind == "removed":
        broken = [item for item in found["leftmax"].items if isinstance(item, Line) and item.dash is Dash.DASHED]
        assert broken


def test_numbered_messages_stand_below_the_picture() -> None:
    text = (
        "process P { in a : int  out b : double  communication { var v : int  }  composition { mu (a ? v ; b ! v) } }"
    )
    checked = check(SourceFile(name="p.csp", text=text), read_source)
    assert checked.readable is not None
    found = Pictures(checked.readable, checked.report.diagnostics)
    definition = found.named("P")
    assert definition is not None
    scene = found.scene(definition, PictureOptions(which="communication"))
    (diagnostic,) = checked.report.diagnostics
    assert diagnostic.code in words(scene)
    assert " ".join(words(scene)).count(diagnostic.message.split()[0]) >= 1
    badges = [item.kind for item in every(scene.items) if isinstance(item, Group) and item.kind.startswith("badge")]
    assert sorted(badges) == ["badge error", "badge error", "badge highlighted"]


def test_the_inside_of_a_box_lies_within_it() -> None:
    found = groups(draw_communication(diagram("jiwy/jiwy.csp", "Jiwy", depth=2)))
    outer = next(item.place for item in found["horizontal"].items if isinstance(item, Box))
    for name in ("alignL", "alignR", "motionControl", "homing"):
        inner = next(item.place for item in found[f"horizontal/{name}"].items if isinstance(item, Box))
        assert outer.contains(inner)


@pytest.mark.parametrize("name", ["jiwy/jiwy.csp", "ring/ring.csp", "buffer/buffer.csp", "emergency/emergency.csp"])
def test_the_same_program_is_drawn_the_same(name: str) -> None:
    one, other = pictures(name), pictures(name)
    for definition in one.drawn()[-3:]:
        again = other.named(definition.name.text)
        assert again is not None
        assert one.scene(definition) == other.scene(again)


def test_unconnected_elements_are_below_the_rest() -> None:
    found = groups(draw_communication(diagram("jiwy/jiwy.csp", "MotionControl"), hidden=NOTHING_HIDDEN))
    failed = next(item.place for item in found["failed"].items if isinstance(item, Box))
    servo = next(item.place for item in found["servo"].items if isinstance(item, Box))
    assert failed.y > servo.bottom
