"""Composition diagrams: what they consist of, and that readers can follow them."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, note, settings
from hypothesis import strategies as st

from cspdiag import pipeline
from cspdiag.base import Report, SourceFile
from cspdiag.base.record import replaced
from cspdiag.base.sources import read_source
from cspdiag.draw.composition.blocks import MOST_LINES, PARENTHESIS
from cspdiag.draw.composition.diagram import draw_composition
from cspdiag.draw.composition.legend import explanations
from cspdiag.draw.elements.composition import CompositionDiagram, outline
from cspdiag.draw.elements.marks import Mark, MarkKind
from cspdiag.draw.elements.read_composition import composition_diagram
from cspdiag.draw.hiding import hidden
from cspdiag.draw.output.svg import render_svg
from cspdiag.draw.scene.geometry import Point
from cspdiag.draw.scene.scene_geometry import every, moved
from cspdiag.draw.scene.shapes import Box, Dash, Ellipse, Group, Ink, Item, Line, Scene, Text
from cspdiag.syntax import ast
from cspdiag.syntax.parser import parse
from tests.draw.composition.random_compositions import random_composition
from tests.draw.geometry.compositions import faults, measured
from tests.properties.programs import programs

MODELS = sorted(Path("models").glob("*/*.csp"))


def processes(tree: ast.SourceTree) -> list[ast.ProcessDefinition]:
    return [item for item in tree.items if isinstance(item, ast.ProcessDefinition)]


def diagrams(text: str) -> list[CompositionDiagram]:
    tree = parse(SourceFile(name="random.csp", text=text), Report())
    assert tree is not None
    found = processes(tree)
    definitions = {item.name.text: item for item in tree.items if not isinstance(item, ast.Import | ast.Assertion)}
    return [composition_diagram(definitions, process) for process in found if process.composition is not None]


def diagram(composition: str) -> CompositionDiagram:
    """The diagram of a process with this composition, which need not have a meaning."""
    (found,) = diagrams(f"process P {{ composition {{ {composition} }} }}")
    return found


@pytest.mark.parametrize("path", MODELS, ids=str)
def test_models_are_drawn_without_faults(path: Path) -> None:
    checked = pipeline.check(read_source(str(path)), read_source)
    assert checked.program is not None
    for definition in checked.program.definitions.values():
        if isinstance(definition, ast.ProcessDefinition) and definition.composition is not None:
            scene = draw_composition(composition_diagram(checked.program.definitions, definition))
            assert measured(scene).shapes
            assert faults(scene) == []


@settings(max_examples=200, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.integers(min_value=0))
def test_any_composition_is_drawn_without_faults(seed: int) -> None:
    composition = random_composition(seed)
    note(composition)
    scene = draw_composition(diagram(composition))
    assert measured(scene).shapes
    assert faults(scene) == []


@settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck))
@given(programs())
def test_random_programs_are_drawn_deterministically_and_without_faults(text: str) -> None:
    note(text)
    first, second = diagrams(text), diagrams(text)
    assert first
    assert [outline(each) for each in first] == [outline(each) for each in second]
    for one, other in zip(first, second, strict=True):
        scene = draw_composition(one)
        assert faults(scene) == []
        assert render_svg(scene) == render_svg(draw_composition(other))


@pytest.mark.parametrize("away", [(0, -30), (0, 45), (-40, 0)])
def test_the_measurement_detects_a_moved_process(away: tuple[float, float]) -> None:
    scene = draw_composition(diagram("first ; (second || third) ; (mu last until done)"))
    assert faults(scene) == []

    def damaged(item: Item) -> Item:
        if not isinstance(item, Group):
            return item
        if item.id == "step-1.2.2":
            return moved(item, *away)
        return replaced(item, items=tuple(damaged(each) for each in item.items))

    assert faults(replaced(scene, items=tuple(damaged(each) for each in scene.items)))


def test_every_element_is_drawn_once_under_its_key() -> None:
    found = diagram("(mu (a ? x -> skip [] after 1 ms -> (b ; c)) until x) catch E -> skip ; if x then d")
    ids = [item.id for item in every(draw_composition(found).items) if isinstance(item, Group) and item.id]
    assert len(ids) == len(set(ids))
    keys = {element.key for element in found.elements()}
    assert {each.removeprefix("step-") for each in ids} <= keys
    leaves = {key for key in keys if not any(other.startswith(f"{key}.") for other in keys)}
    assert {f"step-{key}" for key in leaves} <= set(ids)


NESTED = """
process Leaf { in a : int  communication { var x : int = 0 }  composition { a ? x } }
process Middle { in a : int
  communication { first : Leaf  second : Leaf  a -> first.a, second.a }
  composition { first ; second }
}
process Top { in a : int
  communication { one : Middle  other[2] : Middle  a -> one.a, other[0].a, other[1].a }
  composition { one ; other[1] }
}
process Endless { communication { again : Endless } composition { skip ; again } }
"""


def test_instances_show_their_inside_to_the_requested_depth() -> None:
    tree = parse(SourceFile(name="nested.csp", text=NESTED), Report())
    assert tree is not None
    definitions = {process.name.text: process for process in processes(tree)}

    def shown(name: str, depth: int) -> list[str]:
        found = composition_diagram(definitions, definitions[name], depth)
        assert faults(draw_composition(found)) == []
        return [line.strip() for line in outline(found).splitlines()]

    flat = ["composition of Top", "sequence ;", "run one : Middle (process)", "run other[1] : Middle (process)"]
    assert shown("Top", 1) == flat
    middle = ["sequence ;", "run first : Leaf (process)", "run second : Leaf (process)"]
    assert shown("Top", 2) == [*flat[:2], "inside one : Middle", *middle, "inside other[1] : Middle", *middle]
    assert shown("Top", 3).count("read a ? x") == 4
    assert shown("Top", 3) == shown("Top", 9)
    assert shown("Endless", 9) == shown("Endless", 1)


def test_tall_groups_are_side_by_side() -> None:
    tall = " ; ".join(f"(process_number_{number} || skip || skip)" for number in range(40))
    scene = draw_composition(diagram(f"h: ({tall}) ||> v: ({tall})"))
    assert faults(scene) == []
    first, second = (measured(scene).frames[f"step-1.{number}"] for number in (1, 2))
    assert first.y == second.y
    assert first.right < second.x
    (head,) = signs(scene, "parallel")
    assert head[2].x > head[0].x, "the first stands at the left"


def signs(scene: Scene, kind: str) -> list[tuple[Point, ...]]:
    """The closed outlines among the signs of relations."""
    return [
        item.points
        for group in every(scene.items)
        if isinstance(group, Group) and group.kind.startswith(f"relation {kind}")
        for item in every(group.items)
        if isinstance(item, Line) and item.closed
    ]


@pytest.mark.parametrize("operator", ["||>", "[]>"])
def test_the_head_of_a_priority_points_to_the_lower(operator: str) -> None:
    first, second = ("a -> skip", "b -> skip") if operator == "[]>" else ("a", "b")
    (head,) = signs(draw_composition(diagram(f"{first} {operator} {second}")), "")
    base, tip = head[0].y, head[2].y
    assert tip > base, "the first stands above the second"
    plain = draw_composition(diagram(f"{first} {operator.removesuffix('>')} {second}"))
    assert signs(plain, "") == []


def parentheses(scene: Scene) -> int:
    """The number of line ends with the little circle."""
    return sum(
        isinstance(item, Ellipse) and item.place.width == PARENTHESIS
        for group in every(scene.items)
        if isinstance(group, Group) and group.kind.startswith("relation")
        for item in every(group.items)
    )


def test_a_line_that_ends_at_a_group_carries_a_parenthesis() -> None:
    assert parentheses(draw_composition(diagram("a ; b ; c"))) == 0
    assert parentheses(draw_composition(diagram("a ; (b || c)"))) == 1
    assert parentheses(draw_composition(diagram("a ; (b || c) ; d"))) == 2
    assert parentheses(draw_composition(diagram("h: (a ; b) || v: (c ; d)"))) == 2


def test_a_long_sequence_continues_in_new_rows_and_a_long_parallel_in_new_columns() -> None:
    names = [f"process_number_{number}" for number in range(24)]
    sequence = draw_composition(diagram(" ; ".join(names)))
    assert sequence.width < 1150
    assert len({shape.y for shape in measured(sequence).shapes.values()}) > 2
    parallel = draw_composition(diagram(" || ".join(names)))
    assert parallel.height < 1100
    assert len({shape.x for shape in measured(parallel).shapes.values()}) > 1
    assert faults(sequence) == faults(parallel) == []


def test_a_change_at_the_end_moves_nothing_before_it() -> None:
    before = measured(draw_composition(diagram("first ; (second || third) ; fourth"))).shapes
    after = measured(draw_composition(diagram("first ; (second || third) ; fourth ; fifth"))).shapes
    assert before.items() < after.items()


@pytest.mark.parametrize(
    ("kind", "ink"),
    [("error", Ink.ERROR), ("warning", Ink.WARNING), ("added", Ink.ADDED), ("removed", Ink.REMOVED)],
)
@pytest.mark.parametrize(
    "key", ["1", "1.1", "1.2", "1.2.1", "1.2.1.1", "1.2.2", "1.3.1", "1.3.2", "1.3.2.1", "1.4", "1.4.2", "1.5.2"]
)
def test_any_element_can_be_marked(kind: MarkKind, ink: Ink, key: str) -> None:
    found = diagram(
        "skip ; (b ? x -> stop [] after 1 ms -> b ? x) ; (x := 1 catch F -> b ! x) ; (mu skip until x) ; (while x do "
        "skip)"
    )
    assert key in {element.key for element in found.elements()}
    scene = draw_composition(found, marks={key: Mark(kind=kind, note="because")})
    (group,) = (item for item in every(scene.items) if isinstance(item, Group) and item.id == f"step-{key}")
    assert kind in group.kind.split()
    assert group.title.endswith("because")
    outlines = [each for each in group.items if isinstance(each, Box | Line) and each.stroke is ink]
    assert outlines
    assert all((each.dash is Dash.DASHED) is (kind == "removed") for each in outlines)
    assert any(isinstance(each, Group) and each.kind.startswith("badge") for each in group.items)
    assert faults(scene) == []


def test_long_texts_are_broken_and_their_tooltips_whole() -> None:
    value = " + ".join(f"gain[{number}] * (wanted - latest.temperature)" for number in range(9))
    scene = draw_composition(diagram(f"heater ! {value} ; skip"))
    (group,) = (item for item in every(scene.items) if isinstance(item, Group) and item.id == "step-1.1")
    shown = [run.text for text in group.items if isinstance(text, Text) for run in text.runs]
    assert 1 < len(shown) <= MOST_LINES
    assert shown[-1].endswith("…")
    assert value in group.title


def test_deep_nesting_is_drawn() -> None:
    text = "skip"
    for _ in range(60):
        text = f"(mu {text})"
    assert faults(draw_composition(diagram(text))) == []


def test_tooltips_describe_instances() -> None:
    text = """
    /// Holds its set-point.
    submodel Law { in x : double out y : double y = x }
    process P { in x : double out y : double
      communication {
        /// Of the pan joint.
        law : Law  x -> law.x  law.y -> y }
      composition { mu law }
    }"""
    (found,) = diagrams(text)
    scene = draw_composition(found, links={"Law": "#Law"})
    (group,) = (item for item in every(scene.items) if isinstance(item, Group) and item.id == "step-1.1")
    assert group.kind == "instance submodel"
    assert group.title == "submodel law : Law\nOf the pan joint.\nHolds its set-point.\nrandom.csp:8"
    assert group.link == "#Law"


@pytest.mark.parametrize(
    ("composition", "expected"),
    [
        ("a ; b", []),
        ("a || b", ["parallel"]),
        ("a ||> b", ["parallel, priority to the first"]),
        ("par i < 3 : a", ["parallel"]),
        ("a -> skip [] b -> skip", ["alternative"]),
        ("a -> skip []> b -> skip", ["alternative, priority to the first"]),
        ("a ; (b ; c)", ["parenthesis"]),
        ("h: (b ; c)", []),
        ("a ; h: b", ["parenthesis"]),
        ("mu a", ["repetition"]),
        ("while x do (a ; b)", ["parenthesis", "repetition"]),
        ("a catch E -> b", ["exception"]),
        ("a interrupt b -> c", ["interrupt"]),
        ("(if x then a else b) || c", ["parallel", "parenthesis"]),
    ],
)
def test_the_legend_explains_the_signs_that_occur(composition: str, expected: list[str]) -> None:
    found = diagram(composition)
    assert [words for words, _ in explanations(found)] == expected
    scene = draw_composition(found)
    assert (parentheses(scene) > 0) is ("parenthesis" in expected)
    legends = [item for item in scene.items if isinstance(item, Group) and item.kind == "legend"]
    assert len(legends) == bool(expected)
    bare = draw_composition(found, hidden=hidden(["legend"]))
    assert not any(isinstance(item, Group) and item.kind == "legend" for item in bare.items)
