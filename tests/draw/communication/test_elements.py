"""What communication diagrams consist of, before layout."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings

from cspdiag.base import SourceFile
from cspdiag.base.sources import read_source
from cspdiag.draw.elements.communication import communication_diagram
from cspdiag.draw.elements.diagram import Arrow, Box, CommunicationDiagram, ParentPort
from cspdiag.draw.elements.listing import listing
from cspdiag.draw.elements.marks import WHOLE, Mark, mark_of_rest, marks_of, numbered
from cspdiag.draw.pictures import Pictures, places_of
from cspdiag.model.sampling import Sampling
from cspdiag.pipeline import check
from tests.properties.programs import programs

ROOT = Path(__file__).parents[3]
MODELS = sorted(path.relative_to(ROOT).as_posix() for path in ROOT.glob("models/*/*.csp"))


def pictures(text: str) -> Pictures:
    checked = check(SourceFile(name="drawn.csp", text=text), read_source)
    assert checked.readable is not None
    return Pictures(checked.readable, checked.report.diagnostics)


def drawn(text: str, name: str, depth: int = 1) -> CommunicationDiagram:
    found = pictures(text)
    definition = found.named(name)
    assert definition is not None
    return found.communication(definition, depth)


def arrow(diagram: CommunicationDiagram, key: str) -> Arrow:
    (found,) = [each for each in diagram.arrows if each.key == key]
    return found


def box(diagram: CommunicationDiagram, key: str) -> Box:
    (found,) = [each for each in diagram.boxes if each.key == key]
    return found


@pytest.mark.parametrize("name", MODELS)
def test_the_models_have_the_elements_of_the_golden_files(
    name: str, pytestconfig: pytest.Config, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(ROOT)
    checked = check(read_source(name), read_source)
    assert checked.program is not None
    found = Pictures(checked.program)
    text = "\n".join(listing(found.communication(definition)) for definition in found.drawn())
    golden = ROOT / "tests" / "golden" / "communication" / f"{Path(name).parent.name}-{Path(name).stem}.txt"
    if not text:
        assert not golden.exists()
        return
    if pytestconfig.getoption("--update-golden"):
        golden.parent.mkdir(exist_ok=True)
        golden.write_text(text)
    assert golden.read_text() == text


KINDS = """
process Source {{ out a : int  composition {{ mu a ! 1 }} }}
process Drain {{ in a : int  communication {{ var v : int }}  composition {{ mu a ? v }} }}
process Net {{
  communication {{
    source : Source
    drain  : Drain
    other  : Drain
    source.a -> line : int {kind} -> drain.a, other.a
  }}
  composition {{ {composition} }}
}}
"""


@pytest.mark.parametrize("kind", ["broadcast", "any", "buffer 4", "overwrite 2"])
def test_the_requested_kind_is_known_with_its_capacity(kind: str) -> None:
    line = arrow(drawn(KINDS.format(kind=kind, composition="source || drain || other"), "Net"), "line")
    name, _, capacity = kind.partition(" ")
    assert line.requested == name
    assert line.capacity == (capacity or None)


def test_kinds_that_are_not_requested_are_those_inferred() -> None:
    text = KINDS.replace(", other.a", "").replace("    other  : Drain\n", "")
    parallel = arrow(drawn(text.format(kind="", composition="source || drain"), "Net"), "line")
    sequential = arrow(drawn(text.format(kind="", composition="source ; drain"), "Net"), "line")
    assert parallel.kinds == ("sync",)
    assert sequential.kinds == ("var",)


PERIODS = """
process Inner(T: time) {
  in  u : double @ T
  out y : double @ T
  communication { var v : double }
  composition { mu (u ? v ; y ! v) }
}
process Outer {
  in  a, b : double @ 2 ms
  in  c, d : double @ 5 ms
  out e, f : double @ 2 ms
  out g : double @ 5 ms
  communication {
    fast : Inner(2 ms)
    slow : Inner(5 ms)
    a -> fast.u
    fast.y -> e
    c -> slow.u
    slow.y -> g
  }
  composition { fast || slow }
}
"""


def test_each_instance_has_the_periods_of_its_own_ports() -> None:
    outer = drawn(PERIODS, "Outer")
    assert [port.periods for port in box(outer, "fast").ports] == [(Sampling(2_000_000),)] * 2
    assert [port.periods for port in box(outer, "slow").ports] == [(Sampling(5_000_000),)] * 2
    inner = drawn(PERIODS, "Inner")
    ports = [vertex for vertex in inner.vertices if isinstance(vertex, ParentPort)]
    assert [(port.period, port.periods) for port in ports] == [("T", (Sampling(2_000_000), Sampling(5_000_000)))] * 2


ARRAYS = """
process Cell { in left : int  out right : int  communication { var v : int }  composition { mu (left ? v ; right ! v) } }
process Chain {
  in  first : int
  out last : int
  communication {
    cell[1000] : Cell
    first -> cell[0].left
    for i < 999 {
      cell[i].right -> cell[i + 1].left
    }
    cell[999].right -> last
  }
  composition { par i < 1000 : cell[i] }
}
"""


def test_an_array_is_one_box_whose_ports_carry_the_indexes_of_the_text() -> None:
    chain = drawn(ARRAYS, "Chain")
    assert len(chain.boxes) == 1
    cell = box(chain, "cell")
    assert cell.size == "1000"
    assert [port.key for port in cell.ports] == ["[0].left", "[i + 1].left", "[i].right", "[999].right"]
    repeated = arrow(chain, "cell[i].right -> cell[i + 1].left")
    assert repeated.repeated == ("i < 999",)
    assert repeated.kinds == ("sync",)


ITSELF = """
process P {
  in  a : int
  out b, c, d : int
  communication {
    var x : int
    var row : int[2] = [0, 0]
  }
  composition { mu (a ? row[1] ; x := row[0] ; b ! row[1] ; c ! x + 1 ; d ! 5 ; b ! row[0]) }
}
"""


def test_what_the_process_itself_reads_and_writes_is_drawn_once_for_each_pair() -> None:
    relations = {(str(each.sources[0]), str(each.sinks[0])) for each in drawn(ITSELF, "P").arrows}
    assert relations == {
        ("a", "row"),
        ("row", "b"),
        ("x", "c ! x + 1"),
        ("c ! x + 1", "c"),
        ("d ! 5", "d"),
    }
    assert all(each.by_composition for each in drawn(ITSELF, "P").arrows)


DEFAULTS = """
process Leaf { in a : int = 7  in b : int  out c : int  composition { mu c ! 1 } }
process P {
  out c : int
  communication { leaf : Leaf  leaf.c -> c }
  composition { leaf }
}
"""


def test_an_unconnected_port_shows_its_default_or_that_it_has_none() -> None:
    ports = {port.key: port for port in box(drawn(DEFAULTS, "P"), "leaf").ports}
    assert (ports["a"].is_connected, ports["a"].default) == (False, "7")
    assert (ports["b"].is_connected, ports["b"].default) == (False, None)
    assert (ports["c"].is_connected, ports["c"].default) == (True, None)


def test_hand_written_bodies_and_drivers_are_distinguished_from_others() -> None:
    text = """
driver Stick(port: text) python "stick.py:Stick" { out x : double }
submodel Plant python "plant.py:Plant" { in u : double  out y : double }
process Law c "law.c" { in x : double  in y : double  out u : double }
environment Rig for Law {
  stick : Stick(port = "js0")
  plant : Plant
  stick.x -> x
  u -> plant.u
  plant.y -> y
}
"""
    rig = drawn(text, "Rig")
    assert [(each.key, each.kind, each.language) for each in rig.boxes] == [
        ("Law", "process", "c"),
        ("stick", "driver", "python"),
        ("plant", "submodel", "python"),
    ]
    assert [port.key for port in box(rig, "Law").ports] == ["x", "y", "u"]


BROKEN = """
submodel Law { in e : double<rad>  in w : double<rad>  out u : double<V>  u = 1<V/rad> * (e - w) }
process Loop {
  in  e : double<rad>
  in  w : double<deg>
  out u : double<V>
  communication {
    law : Law
    extra : Nothing
    e -> law.e
    w -> law.w
    law.u -> u
    nobody.x -> extra.y
  }
  composition { mu law }
}
"""


def test_a_program_with_errors_keeps_what_can_be_drawn() -> None:
    loop = drawn(BROKEN, "Loop")
    assert [(each.key, each.kind) for each in loop.boxes] == [
        ("law", "submodel"),
        ("extra", "unknown"),
        ("nobody", "unknown"),
    ]
    assert arrow(loop, "nobody.x -> extra.y").sources[0].port == "x"


def test_marks_belong_to_the_smallest_element_around_the_places_of_a_diagnostic() -> None:
    found = pictures(BROKEN)
    definition = found.named("Loop")
    assert definition is not None
    diagnostics = found.concerned(definition)
    marks = marks_of(places_of(found.communication(definition)), diagnostics)
    reported = {key: [diagnostics[number].code for number in mark.numbers] for key, mark in marks.items()}
    wrong = {"extra": ["E0204"], "w -> law.w": ["E0316"], "nobody": ["E0204"]}
    assert reported == wrong | {"w": ["E0316"]}
    assert {key for key, mark in marks.items() if mark.kind == "error"} == wrong.keys()
    assert marks["w"].kind == "highlighted"
    assert "declared as double<deg>" in marks["w"].note
    assert "double<deg>" in marks["w -> law.w"].note


def test_a_diagnostic_outside_every_element_marks_nothing() -> None:
    found = pictures(BROKEN)
    diagnostics = numbered(found.diagnostics)
    assert marks_of({"elsewhere": ()}, diagnostics) == {}


def test_a_definition_that_cannot_be_read_is_omitted_and_the_others_are_drawn() -> None:
    found = pictures(BROKEN + "process Bad { communication { a -> -> b } }\n")
    assert [definition.name.text for definition in found.drawn()] == ["Loop"]


def test_the_inside_of_instances_is_shown_to_the_requested_depth() -> None:
    checked = check(read_source(str(ROOT / "models/jiwy/jiwy.csp")), read_source)
    assert checked.program is not None
    found = Pictures(checked.program)
    jiwy = found.outermost()
    assert jiwy is not None
    assert jiwy.name.text == "Jiwy"
    for depth in (1, 2, 3):
        levels = 0
        level = found.communication(jiwy, depth)
        inner: CommunicationDiagram | None = level
        while inner is not None:
            levels += 1
            inner = next((each.inside for each in inner.boxes if each.inside is not None), None)
        assert levels == depth


@settings(max_examples=30, deadline=None, suppress_health_check=list(HealthCheck))
@given(programs())
def test_random_programs_have_elements_with_keys_of_their_own(text: str) -> None:
    checked = check(SourceFile(name="random.csp", text=text), read_source)
    assert checked.readable is not None
    found = Pictures(checked.readable)
    definitions = found.drawn()
    assert definitions
    for definition in definitions:
        diagram = found.communication(definition)
        keys = [element.key for element in diagram.elements()]
        assert len(keys) == len(set(keys))
        ends = {end for each in diagram.arrows for end in (*each.sources, *each.sinks)}
        ports = {(each.key, port.key) for each in diagram.boxes for port in each.ports}
        vertices = {vertex.key for vertex in diagram.vertices}
        assert {end.element for end in ends} <= vertices
        boxes = {each.key for each in diagram.boxes}
        assert {(end.element, end.port) for end in ends if end.element in boxes} <= ports
        assert communication_diagram(found.program, found.facts, definition) == diagram


def test_a_diagnostic_that_belongs_to_no_element_marks_the_whole() -> None:
    found = pictures("process P { in a : int  out x : int  composition { x ! 1 } }\nenvironment E for P { x -> _ }\n")
    definition = found.named("E")
    assert definition is not None
    diagnostics = {number: each for number, each in found.concerned(definition).items() if each.code == "E0801"}
    assert len(diagnostics) == 1
    assert marks_of(places_of(found.communication(definition)), diagnostics) == {}
    assert mark_of_rest(diagnostics, ())[WHOLE].numbers == tuple(diagnostics)
    assert mark_of_rest(diagnostics, (Mark("warning", tuple(diagnostics)),)) == {}
