"""Boxes that show their inside: outside connections continue inside, element by element in arrays of ports."""

from __future__ import annotations

from functools import cache

import pytest

from cspdiag.base import SourceFile
from cspdiag.base.sources import read_source
from cspdiag.draw.communication.graph import elements_of
from cspdiag.draw.elements.diagram import BoxPort
from cspdiag.draw.layout.elk import engine_available
from cspdiag.draw.pictures import PictureOptions, Pictures
from cspdiag.draw.scene.scene_geometry import every
from cspdiag.draw.scene.shapes import Box, Group, Line, Scene, Text
from cspdiag.pipeline import check
from tests.draw.geometry.rules import faults

needs_engine = pytest.mark.skipif(
    not engine_available(), reason="the layout engine is not there: make setup fetches it"
)

PROGRAM = """
process Cell(id : int) {
  in  i : int
  out o : int
  out lamps[2] : int
  communication { var v : int = 0 }
  composition { mu (i ? v ; o ! v + id ; lamps[0] ! v ; lamps[1] ! id) }
}
process Two {
  in  keys[3] : int
  out echo[3] : int
  communication { var m : int = 0  var n : int = 0 }
  composition { mu (keys[0] ? m ; keys[2] ? n ; echo[0] ! m ; seq i < 3 : echo[i] ! n) }
}
process Stage {
  in  keys[3] : int
  out echo[3] : int
  communication { two : Two  for i < 3 { keys[i] -> two.keys[i]  two.echo[i] -> echo[i] } }
  composition { two }
}
process Line {
  in  first, key : int
  in  others[2] : int
  out last : int
  out lamp[8] : int
  out echo, more[2] : int
  communication {
    cell[i < 4] : Cell(id = i)
    stage : Stage
    alone : Two
    first -> cell[0].i
    for i < 3 { cell[i].o -> p : int -> cell[i + 1].i }
    cell[3].o -> last
    for i < 4 { cell[i].lamps[0] -> lamp[2 * i]  cell[i].lamps[1] -> lamp[2 * i + 1] }
    key -> stage.keys[0]
    for i < 2 { others[i] -> stage.keys[i + 1] }
    stage.echo[0] -> echo
    for i < 2 { stage.echo[i + 1] -> more[i] }
    alone.echo[0] -> alone.keys[1]
    alone.echo[1] -> alone.keys[0]
    alone.echo[2] -> alone.keys[2]
  }
  composition { (par i < 4 : cell[i]) || stage || alone }
}
submodel S { out o : int  o = 1 }
environment Bench for Line {
  s : S
  t[2] : S
  s.o -> first
  s.o -> key
  for i < 2 { t[i].o -> others[i]  more[i] -> _ }
  last -> _
  echo -> _
  for i < 8 { lamp[i] -> _ }
}
"""


@cache
def scene(definition: str, depth: int) -> Scene:
    checked = check(SourceFile(name="line.csp", text=PROGRAM), read_source)
    assert checked.readable is not None
    found = Pictures(checked.readable)
    drawn = found.named(definition)
    assert drawn is not None
    return found.scene(drawn, PictureOptions(which="communication", depth=depth))


def groups(drawn: Scene) -> dict[str, Group]:
    return {item.id: item for item in every(drawn.items) if isinstance(item, Group) and item.id}


def touching(drawn: Scene, port: str) -> set[str]:
    """The arrows that begin or end at the square of a port."""
    found = groups(drawn)
    (square,) = (item.place for item in found[port].items if isinstance(item, Box))
    return {
        name
        for name, group in found.items()
        for item in group.items
        if isinstance(item, Line) and item.corner > 0
        for end in (item.points[0], item.points[-1])
        if square.grown(1).x <= end.x <= square.grown(1).right and square.y <= end.y <= square.bottom
    }


@needs_engine
def test_every_port_inside_a_box_is_at_its_border() -> None:
    for definition, depth in (("Line", 2), ("Line", 3), ("Bench", 2)):
        drawn = scene(definition, depth)
        assert faults(drawn) == []
        loose = [
            name
            for name, group in groups(drawn).items()
            if "/" in name and "|" not in name and group.kind == "port" and isinstance(group.items[0], Text)
        ]
        assert loose == []


@needs_engine
@pytest.mark.parametrize(
    ("definition", "port", "arrows"),
    [
        ("Bench", "Line|first", {"s.o -> Line.first", "Line/first -> cell[0].i"}),
        ("Bench", "Line|others[i]", {"t[i].o -> Line.others[i]", "Line/others[i] -> stage.keys[i + 1]"}),
        ("Bench", "Line|lamp[i]", {
            "Line.lamp[i] -> Line.lamp[i] -> _",
            "Line/cell[i].lamps[0] -> lamp[2 * i]", "Line/cell[i].lamps[1] -> lamp[2 * i + 1]",
        }),
        ("Line", "cell|[0].i", {"first -> cell[0].i", "cell/i ~> v"}),
        ("Line", "cell|[i + 1].i", {"p", "cell/i ~> v"}),
        ("Line", "cell|[3].o", {"cell[3].o -> last", "cell/o ! v + id ~> o"}),
        ("Line", "cell|[i].lamps[0]", {"cell[i].lamps[0] -> lamp[2 * i]", "cell/v ~> lamps"}),
        ("Line", "cell|[i].lamps[1]", {"cell[i].lamps[1] -> lamp[2 * i + 1]", "cell/lamps ! id ~> lamps"}),
        ("Line", "stage|keys[i + 1]", {"others[i] -> stage.keys[i + 1]", "stage/keys[i] -> two.keys[i]"}),
        ("Line", "alone|keys[0]", {"alone.echo[1] -> alone.keys[0]", "alone/keys ~> m"}),
        ("Line", "alone|keys[1]", {"alone.echo[0] -> alone.keys[1]"}),
        ("Line", "alone|keys[2]", {"alone.echo[2] -> alone.keys[2]", "alone/keys ~> n"}),
        ("Line", "alone|echo[1]", {"alone.echo[1] -> alone.keys[0]", "alone/n ~> echo"}),
        ("Line", "alone|echo[0]", {"alone.echo[0] -> alone.keys[1]", "alone/m ~> echo", "alone/n ~> echo"}),
    ],
)  # fmt: skip
def test_arrows_continue_inside_at_the_elements_that_they_name(definition: str, port: str, arrows: set[str]) -> None:
    assert touching(scene(definition, 2), port) == arrows


@pytest.mark.parametrize(
    ("keys", "index", "expected"),
    [
        (["e"], "", ["e"]),
        (["e[i]"], "[0]", ["e[i]"]),
        (["e[0]", "e[1]"], "[1]", ["e[1]"]),
        (["e[0]", "e[i + 1]"], "[0]", ["e[0]"]),
        (["e[0]", "e[i + 1]"], "[2]", ["e[i + 1]"]),
        (["e[0]", "e[1]"], "[k]", ["e[0]", "e[1]"]),
        (["[0].e", "[i + 1].e"], "", ["[0].e", "[i + 1].e"]),
        (["[0].e[1]", "[i + 1].e[1]", "[i].e[0]"], "[1]", ["[0].e[1]", "[i + 1].e[1]"]),
        (["e[0][1]", "e[1][1]"], "[1][1]", ["e[1][1]"]),
    ],
)
def test_the_elements_that_an_index_inside_means(keys: list[str], index: str, expected: list[str]) -> None:
    ports = [BoxPort(key=key, direction="in", type="int") for key in keys]
    assert {port.name for port in ports} == {"e"}
    assert [port.key for port in elements_of(ports, index)] == expected
