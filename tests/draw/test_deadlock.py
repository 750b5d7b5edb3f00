"""Deadlocks as pictures: the ring of waiting processes, and the diagram around them."""

from __future__ import annotations

from itertools import combinations, pairwise
from pathlib import Path

import pytest

from cspdiag.api import load
from cspdiag.base import SourceFile, Span
from cspdiag.base.sources import read_source
from cspdiag.cli.main import main
from cspdiag.draw.deadlock.marks import StuckProcess, shortened, surroundings
from cspdiag.draw.deadlock.ring import Deadlock, draw_ring
from cspdiag.draw.deadlock.steps import waiting_steps
from cspdiag.draw.layout import engine
from cspdiag.draw.output.svg import render_svg
from cspdiag.draw.scene.geometry import Point, Rectangle, around
from cspdiag.draw.scene.scene_geometry import every
from cspdiag.draw.scene.shapes import Box, Group, Line, Scene, Text
from cspdiag.obligations import proof_obligations
from cspdiag.pipeline import check
from cspdiag.proofs.verdict import Limits
from cspdiag.verify.confirm import Verifier
from cspdiag.verify.deadlock_picture import deadlock_of, deadlock_shown_by

DINING = "models/dining/deadlock.csp"
CROSSED = """
process Left { out a : int  in b : int
  communication { var x : int = 0 }
  composition { a ! 1 ; b ? x }
}
process Right { in a : int  out b : int
  communication { var x : int = 0 }
  composition { b ! 1 ; a ? x }
}
process Pair {
  communication { left : Left  right : Right  left.a -> ping : int -> right.a  right.b -> left.b }
  composition { left || right }
}
process Top {
  communication { pair[2] : Pair  besides : Pair }
  composition { (par i < 2 : pair[i]) || besides }
}
"""


def ring(count: int, *, besides: int = 0) -> Scene:
    waiting = [
        StuckProcess(f"Top.process[{number}]", f"to read Top.link[{number}]", "ring.csp:7") for number in range(count)
    ]
    return draw_ring(Deadlock("deadlock at 1 ms", "Top", tuple(waiting[besides:]), tuple(waiting[:besides])))


def cards(scene: Scene) -> list[Rectangle]:
    groups = [item for item in every(scene.items) if isinstance(item, Group) and item.kind == "waiting"]
    return [next(each.place for each in group.items if isinstance(each, Box)) for group in groups]


def arrows(scene: Scene) -> list[tuple[Point, ...]]:
    return [item.points for item in every(scene.items) if isinstance(item, Line)]


def touches(place: Rectangle, point: Point) -> bool:
    inner, outer = place.grown(-0.01), place.grown(0.01)
    spot = Rectangle(point.x, point.y, 0, 0)
    return outer.contains(spot) and not inner.contains(spot)


@pytest.mark.parametrize("count", [*range(1, 16), 40])
def test_each_arrow_of_a_ring_leads_from_a_process_to_the_next(count: int) -> None:
    scene = ring(count)
    places = cards(scene)
    assert len(places) == len(arrows(scene)) == count
    assert not any(one.overlaps(other) for one, other in combinations(places, 2))
    for number, points in enumerate(arrows(scene)):
        assert touches(places[number], points[0])
        assert touches(places[(number + 1) % count], points[-1])
        for start, end in pairwise(points):
            assert start.x == pytest.approx(end.x) or start.y == pytest.approx(end.y)
            piece = around([Rectangle(each.x - 0.5, each.y - 0.5, 1, 1) for each in (start, end)])
            assert not any(place.grown(-1).overlaps(piece) for place in places)
    bends = sum(len(points) - 2 for points in arrows(scene))
    assert bends <= 3


def test_processes_waiting_in_no_cycle_are_drawn_without_arrows() -> None:
    scene = ring(5, besides=5)
    assert len(cards(scene)) == 5
    assert arrows(scene) == []


def test_processes_waiting_besides_a_cycle_are_listed() -> None:
    scene = ring(5, besides=2)
    assert len(cards(scene)) == 3
    shown = ["".join(run.text for run in item.runs) for item in every(scene.items) if isinstance(item, Text)]
    assert "process[1] waits to read link[1]  ring.csp:7" in shown


def test_names_are_shown_without_that_of_the_outermost_process() -> None:
    assert shortened("Top.pair.left", "Top") == "pair.left"
    assert shortened("to read Top.pair.Top.x or write Top.y", "Top") == "to read pair.Top.x or write y"
    assert shortened("Top", "Top") == ""
    assert shortened("to read OnTop.x", "Top") == "to read OnTop.x"


def test_elements_of_the_diagram_carry_the_numbers_of_the_ring() -> None:
    program = check(read_source(DINING), read_source).program
    assert program is not None
    waiting = [
        StuckProcess("SymmetricTable.philosopher[0]", "…", None, ("SymmetricTable.philosopher[0].second",)),
        StuckProcess("SymmetricTable.fork[1]", "…", None, ("SymmetricTable.philosopher[1].first",)),
        StuckProcess("SymmetricTable.philosopher[1]", "…", None, ("SymmetricTable.philosopher[1].second",)),
    ]
    found = surroundings(program, "SymmetricTable", waiting)
    assert found is not None
    diagram, marks = found
    assert diagram.key == "SymmetricTable"
    assert marks["philosopher"].numbers == (1, 3)
    assert marks["fork"].numbers == (2,)
    assert all(arrow.key in marks for arrow in diagram.arrows)
    assert {mark.kind for mark in marks.values()} == {"highlighted"}


def marked_steps(text: str, *waiting: StuckProcess) -> dict[str, dict[str, tuple[int, ...]]]:
    """By process, the texts of the marked steps, with their numbers."""
    program = check(SourceFile(name="steps.csp", text=text), read_source).program
    assert program is not None
    found = {}
    for diagram, marks in waiting_steps(program, waiting):
        texts = {element.key: getattr(element, "text", "") for element in diagram.elements()}
        found[diagram.key] = {texts[key]: mark.numbers for key, mark in marks.items()}
    return found


STEPS = """
process Chooser { in a, b : int  out c : int
  communication { var x : int = 0 }
  composition {
    mu (a ? x -> a ? x [] b ? x -> b ? x) until x == 1 ;
    c ! 1 ; c ! 2
  }
}
process Top { in a, b : int  out c : int
  communication { chooser : Chooser  a -> chooser.a  b -> chooser.b  chooser.c -> c }
  composition { chooser }
}
"""


def test_the_step_at_which_a_process_waits_is_marked_where_its_line_tells_it() -> None:
    def at(line: int, *ports: str) -> StuckProcess:
        channels = tuple(f"Top.{port}" for port in ports)
        return StuckProcess("Top.chooser", "to read", f"steps.csp:{line}", channels, ports)

    assert marked_steps(STEPS, at(5, "a")) == {"Chooser": {"a ? x": (1,)}}
    assert marked_steps(STEPS, at(5, "a", "b")) == {"Chooser": {"a ? x": (1,), "b ? x": (1,)}}
    assert marked_steps(STEPS, at(5, "b"), at(5, "b")) == {"Chooser": {"b ? x": (1, 2)}}
    assert marked_steps(STEPS, at(6, "c")) == {}, "there are two"
    assert marked_steps(STEPS, at(7, "c")) == {}
    assert marked_steps(STEPS, StuckProcess("Top.nobody", "to read", "steps.csp:5")) == {}
    assert marked_steps(STEPS, StuckProcess("Top.chooser", "to read")) == {}


def test_the_step_at_which_a_process_waits_is_marked_where_its_place_is_known() -> None:
    program = check(SourceFile(name="steps.csp", text=STEPS), read_source).program
    assert program is not None
    source = program.main.span.source
    start = STEPS.index("c ! 2")
    waiting = StuckProcess("Top.chooser", "to write Top.c", span=Span(source, start, start + 5))
    ((diagram, marks),) = waiting_steps(program, [waiting])
    assert [element.key for element in diagram.elements() if getattr(element, "text", "") == "c ! 2"] == [*marks]


@pytest.mark.parametrize(
    ("paths", "diagram", "boxes"),
    [
        (["Top.pair[1].left", "Top.pair[1].right"], "Pair", {"left": (1,), "right": (2,)}),
        (["Top.pair[0].left", "Top.pair[1].left", "Top.besides"], "Top", {"pair": (1, 2), "besides": (3,)}),
    ],
)
def test_the_diagram_is_that_of_the_innermost_process_around(
    paths: list[str], diagram: str, boxes: dict[str, tuple[int, ...]]
) -> None:
    program = check(SourceFile(name="crossed.csp", text=CROSSED), read_source).program
    assert program is not None
    found = surroundings(program, "Top", [StuckProcess(path, "to read", None, (f"{path}.a",)) for path in paths])
    assert found is not None
    assert found[0].key == diagram
    assert {key: found[1][key].numbers for key in boxes} == boxes


NEIGHBOURS = """
process Node(id : int) {
  in  a, b : int
  out x, y : int
  communication { var v : int = 0 }
  composition { mu (x ! id ; y ! id ; a ? v ; b ? v) }
}
process Hub {
  in  r[4] : int
  out s[4] : int
  communication { var v : int = 0 }
  composition { mu (alt i < 4 : r[i] ? v -> s[i] ! v) }
}
process Top {
  communication {
    node[i < 4] : Node(id = i)
    hub : Hub
    for i < 4 {
      node[i].x -> hub.r[i]
      hub.s[i] -> node[i].a
    }
    for i < 2 {
      node[2 * i].y -> node[2 * i + 1].b
      node[2 * i + 1].y -> swap : int buffer 3 -> node[2 * i].b
    }
  }
  composition { (par i < 4 : node[i]) || hub }
}
environment Bench for Top { }
assert Top deadlock free
"""


def test_only_the_relationships_of_the_ring_are_highlighted(tmp_path: Path) -> None:
    """If elements of one array are connected by several relationships, the one where processes wait is highlighted."""
    ring = {"node[i].x -> hub.r[i]", "hub.s[i] -> node[i].a", "node[2 * i].y -> node[2 * i + 1].b"}
    path = tmp_path / "neighbours.csp"
    path.write_text(NEIGHBOURS, encoding="utf-8")
    obligations = proof_obligations(read_source(str(path)), read_source)
    (answer,) = (Verifier(obligations, read_source).answer(each, Limits(60)) for each in obligations.questions)
    assert answer.counterexample is not None
    run = load(str(path)).run()
    assert run.outcome.deadlock is not None
    proved = deadlock_shown_by(answer.counterexample, obligations.network("Top"))
    assert proved is not None
    for deadlock in (proved, deadlock_of(run.outcome.deadlock, run.network)):
        assert {each.path for each in deadlock.cycle} >= {"Top.hub"}
        found = surroundings(obligations.checked.program, "Top", deadlock.cycle, deadlock.declared)
        assert found is not None
        assert {arrow.key for arrow in found[0].arrows if arrow.key in found[1]} == ring


def test_numbers_distinguish_ends_where_no_relationship_declares_the_channel() -> None:
    text = """
    process Node { in a : int  out x : int  communication { var v : int = 0 }  composition { mu (a ? v ; x ! v) } }
    process Top { in e[2] : int  out f[2] : int
      communication {
        node[2] : Node
        e[0] -> node[1].a
        e[1] -> node[0].a
        for i < 2 { node[i].x -> f[i] }
      }
      composition { par i < 2 : node[i] }
    }
    """
    program = check(SourceFile(name="numbers.csp", text=text), read_source).program
    assert program is not None
    waiting = [StuckProcess("Top.node[1]", "to read Top.e[0]", None, ("Top.e[0]",))]
    found = surroundings(program, "Top", waiting)
    assert found is not None
    assert {arrow.key for arrow in found[0].arrows if arrow.key in found[1]} == {"e[0] -> node[1].a"}


@pytest.mark.parametrize("paths", [["Elsewhere.x"], ["Top.nobody.x", "Top.nobody.y"], []])
def test_processes_that_are_not_in_the_program_have_no_surroundings(paths: list[str]) -> None:
    program = check(SourceFile(name="crossed.csp", text=CROSSED), read_source).program
    assert program is not None
    assert surroundings(program, "Top", [StuckProcess(path, "to read") for path in paths]) is None


@pytest.mark.parametrize("target", ["python", "c"])
def test_run_draws_its_deadlock(target: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    picture = tmp_path / "dead lock.svg"
    assert main(["run", DINING, "--target", target, "--draw-deadlock", str(picture)]) == 1
    assert f"wrote {picture}" in capsys.readouterr().err
    text = picture.read_text(encoding="utf-8")
    for number in range(5):
        assert f">fork[{number}]<" in text
        assert f">waits to write philosopher[{number}].second<" in text
    assert "each process waits for the one that its arrow leads to" in text
    assert ("Every philosopher takes the left fork first" in text) is engine.available()
    assert (">Philosopher</tspan>" in text and ">Fork</tspan>" in text) is engine.available()


KNOT = """
process Left { out a : int  in b : int
  communication { var x : int = 0 }
  composition { a ! 1 ; b ? x }
}
process Right { in a : int  out b : int
  communication { var x : int = 0 }
  composition { b ! 1 ; a ? x }
}
process Clock { in t : int  communication { var n : int = 0 }  composition { mu t ? n } }
process Top { in t : int
  communication {
    left : Left  right : Right  clock : Clock
    left.a -> ping : int -> right.a  right.b -> pong : int -> left.b  t -> clock.t
  }
  composition { left || right || clock }
}
assert Top livelock free
assert Top deadlock free
"""


def test_verify_draws_the_processes_that_it_finds_stuck(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    program, picture = tmp_path / "knot.csp", tmp_path / "knot.svg"
    program.write_text(KNOT, encoding="utf-8")
    assert main(["verify", str(program), "--draw", str(picture)]) == 1
    text = picture.read_text(encoding="utf-8")
    assert ">knot after " in text
    assert ">waits to write ping<" in text
    assert ">waits to write pong<" in text
    assert capsys.readouterr().err.endswith(f"\nwrote {picture}\n")


def test_verify_draws_nothing_where_all_is_proved(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    program, picture = tmp_path / "fine.csp", tmp_path / "fine.svg"
    program.write_text("process Fine { composition { skip } }\nassert Fine deadlock free\n", encoding="utf-8")
    assert main(["verify", str(program), "--draw", str(picture)]) == 0
    assert f"no processes wait forever, so {picture} was not written" in capsys.readouterr().err
    assert not picture.exists()
    assert main(["verify", str(program), "--draw", str(tmp_path / "fine.txt")]) == 2


def test_a_run_without_a_deadlock_draws_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    picture = tmp_path / "deadlock.svg"
    assert main(["run", "models/dining/dining.csp", "--draw-deadlock", str(picture)]) == 0
    assert f"no deadlock: {picture} was not written" in capsys.readouterr().err
    assert not picture.exists()


def test_a_picture_that_could_not_be_written_is_refused_before_the_run(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", DINING, "--draw-deadlock", str(tmp_path / "deadlock.txt")]) == 2
    assert main(["run", DINING, "--draw-deadlock", str(tmp_path / "none" / "deadlock.svg")]) == 2
    shown = capsys.readouterr().err
    assert "the name must end in .svg, .png or .pdf" in shown
    assert "there is no folder" in shown
    assert "deadlock at" not in shown


def test_a_deadlock_is_drawn_from_python(tmp_path: Path) -> None:
    program = load(DINING)
    drawing = program.draw_deadlock(program.run())
    drawing.save(tmp_path / "deadlock.svg")
    assert main(["run", DINING, "--quiet", "--draw-deadlock", str(tmp_path / "run.svg")]) == 1
    assert (tmp_path / "deadlock.svg").read_text() == (tmp_path / "run.svg").read_text()
    with pytest.raises(ValueError, match="did not end in a deadlock: terminated"):
        program.draw_deadlock(load("models/dining/dining.csp").run())


def test_drawings_are_deterministic() -> None:
    assert render_svg(ring(7, besides=2)) == render_svg(ring(7, besides=2))
