"""Symbols where arrows of several kinds leave one place: each is where its arrow runs alone."""

from __future__ import annotations

import pytest

from cspdiag.base import SourceFile
from cspdiag.base.sources import read_source
from cspdiag.draw.communication import symbols
from cspdiag.draw.communication.symbol_places import symbol_pieces
from cspdiag.draw.hiding import ALL_LABELS, NOTHING_HIDDEN
from cspdiag.draw.layout.elk import engine_available
from cspdiag.draw.layout.graph import Route, Section
from cspdiag.draw.pictures import PictureOptions, Pictures
from cspdiag.draw.scene.geometry import Point
from cspdiag.draw.scene.scene_geometry import every
from cspdiag.draw.scene.shapes import Group
from cspdiag.pipeline import check
from tests.draw.geometry.rules import faults

KINDS = ["overwrite 2", "buffer 3", "any", "broadcast", "sync"]


def program(kinds: tuple[str, ...]) -> str:
    """A variable that is written to channels of several kinds and to an event, and an environment with such forks."""
    names = range(len(kinds))
    channels = "  ".join(f"channel c{i} : int {kind}  var k{i} : int = 0" for i, kind in enumerate(kinds))
    writes = "".join(f" ; c{i} ! m" for i in names)
    reads = "".join(f" || (mu c{i} ? k{i})" for i in names)
    return f"""
    process Forks {{
      in  e : int
      out em, en : int
      communication {{ {channels}  var m : int = 0 }}
      composition {{ (mu (e ? m{writes} ; em ! m ; en ! m)){reads} }}
    }}
    process Around {{
      in  e : int
      in  s : int @ 10 ms
      out em, en : int
      communication {{ forks : Forks  e -> forks.e  forks.em -> em  forks.en -> en  var x : int = 0 }}
      composition {{ forks || (mu s ? x) }}
    }}
    submodel Plant {{ out o : int  o = 1 }}
    environment Bench for Around {{ plant : Plant  plant.o -> e  plant.o -> s  em -> _  en -> _ }}
    """


def pictures(text: str) -> Pictures:
    checked = check(SourceFile(name="forks.csp", text=text), read_source)
    assert checked.readable is not None
    assert not [each for each in checked.report.diagnostics if each.code.startswith("E")]
    return Pictures(checked.readable)


@pytest.mark.skipif(not engine_available(), reason="the layout engine is not there: make setup fetches it")
@pytest.mark.parametrize("kinds", [("overwrite 2",), ("buffer 3", "sync"), tuple(KINDS)])
def test_no_symbol_is_on_an_arrow_of_another_kind(kinds: tuple[str, ...]) -> None:
    found = pictures(program(kinds))
    for definition in found.drawn():
        for hidden in (NOTHING_HIDDEN, ALL_LABELS):
            scene = found.scene(definition, PictureOptions(which="communication", hidden=hidden, depth=3))
            assert faults(scene) == [], definition.name.text


@pytest.mark.skipif(not engine_available(), reason="the layout engine is not there: make setup fetches it")
def test_each_branch_of_a_fork_has_its_symbol() -> None:
    found = pictures(program(("overwrite 2", "any", "sync")))
    forks, bench = found.named("Forks"), found.named("Bench")
    assert forks is not None
    assert bench is not None
    arrows = {
        item.id: {type(each) for each in item.items}
        for definition in (forks, bench)
        for item in every(found.scene(definition, PictureOptions(which="communication")).items)
        if isinstance(item, Group)
    }
    plain = arrows["m ~> c2"]
    assert [name for name in ("m ~> c0", "m ~> em", "m ~> en", "plant.o -> Around.e") if arrows[name] == plain] == []


def path(*places: tuple[float, float], source: str | None = "m") -> Section:
    return Section(tuple(Point(x, y) for x, y in places), source, None)


KNOWN: dict[str, symbols.Symbol | None] = {"one": "event", "other": "buffer", "same": "event"}


def test_a_symbol_is_placed_after_the_fork() -> None:
    routes = {
        "one": Route((path((0, 0), (100, 0)),)),
        "other": Route((path((0, 0), (20, 0), (20, 50), (100, 50)),)),
    }
    ((begin, towards),) = symbol_pieces(routes, KNOWN)["one"]["m"]
    assert begin.x > 20
    assert towards == Point(100, 0)
    ((begin, _),) = symbol_pieces(routes, KNOWN)["other"]["m"]
    assert begin == Point(25, 50), "a level piece with room is better than an upright one"


def test_arrows_of_one_kind_share_their_symbol() -> None:
    routes = {
        "one": Route((path((0, 0), (100, 0)),)),
        "same": Route((path((0, 0), (20, 0), (20, 50), (100, 50)),)),
    }
    assert symbol_pieces(routes, KNOWN)["one"] == {"m": {(Point(0, 0), Point(100, 0))}}
    assert symbol_pieces(routes, KNOWN)["same"] == {"m": {(Point(0, 0), Point(20, 0))}}


def test_an_arrow_that_forks_has_its_symbol_once_where_it_has_parted_from_the_others() -> None:
    trunk, up, down = (
        path((0, 0), (20, 0), (20, 50), (90, 50)),
        path((90, 50), (200, 50), source=None),
        path((90, 50), (90, 99), (200, 99), source=None),
    )
    routes = {"one": Route((trunk, up, down)), "other": Route((path((0, 0), (100, 0)),))}
    assert symbol_pieces(routes, KNOWN)["one"] == {"m": {(Point(25, 50), Point(90, 50))}}
