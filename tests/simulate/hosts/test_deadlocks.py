"""In real time, a deadlock across places is reported in each of them, and nothing else is taken for one."""

from __future__ import annotations

import time
from concurrent.futures import ThreadPoolExecutor

import pytest

from cspdiag.simulate.result import Run
from tests.simulate.hosts.places import Air, begin

RING = """
process Node(first : bool, last : int) {
  in  left  : int
  out right : int
  out seen  : int @ 10 ms safe -5
  communication { var n : int = 0  var k : int = 0 }
  composition {
    (if first then right ! 0) ;
    mu (left ? n ; k := k + 1 ; seen ! n ; wait 3 ms ; (if k < last then right ! n + 1))
  }
}

process Ring {
  out a, b, c : int @ 10 ms safe -5
  communication {
    x : Node(first = true, last = 20)
    y : Node(first = false, last = LAST)
    z : Node(first = false, last = 20)
    x.right -> y.left
    y.right -> z.left
    z.right -> x.left
    x.seen -> a
    y.seen -> b
    z.seen -> c
  }
  composition { x || y || z }
}

environment Bench for Ring on miss count place one : x place two : y place three : z { a -> _  b -> _  c -> _ }
"""


def runs(text: str, air: Air, seconds: float, places: tuple[str, ...] = ("one", "two", "three")) -> list[Run]:
    """The runs of all places in real time."""
    with ThreadPoolExecutor(len(places)) as pool:
        begun = [begin(pool, text, each, air, real_time=True, until=round(seconds * 1e9)) for each in places]
        return [each.result(60) for each in begun]


@pytest.mark.parametrize("air", [Air(), Air(loss=0.2, delay=0.1)], ids=["well", "bad"])
def test_a_deadlock_is_reported_in_all_places_with_their_outputs_released(air: Air) -> None:
    found = runs(RING.replace("LAST", "3"), air, 30)
    assert [run.outcome.ended for run in found] == ["deadlock"] * 3
    for run, process, writer in zip(found, "xyz", "zxy", strict=True):
        assert run.outcome.deadlock is not None
        waiting = {each.path: each.waits for each in run.outcome.deadlock.waiting}
        assert waiting[f"Ring.{process}"] == f"to read Ring.{writer}.right"
        assert run.outcome.deadlock.time < run.outcome.time
        assert [value for _, _, value in run.releases] == [-5]


def test_a_place_that_waits_for_a_time_makes_no_deadlock() -> None:
    text = RING.replace("LAST", "3").replace("wait 3 ms ;", "wait (if k == 2 then 3 s else 1 ms) ;")
    found = runs(text, Air(loss=0.1, delay=0.05), 5)
    assert [run.outcome.ended for run in found] == ["time limit"] * 3


def test_a_link_that_was_lost_in_between_makes_no_deadlock() -> None:
    text = RING.replace("LAST", "1000").replace("last = 20", "last = 1000")
    text = text.replace("var n : int = 0", "var n : int = 0  var done : bool = false")
    # Nothing is given up: a value that nobody has would be a deadlock.
    again = "(done := false ; mu ((DOING ; done := true) catch Timeout -> wait 20 ms) until done)"
    text = text.replace("left ? n ;", f"{again.replace('DOING', 'left ? n')} ;")
    text = text.replace("right ! n + 1)", f"{again.replace('DOING', 'right ! n + 1')})")
    air = Air(delay=0.01)
    with ThreadPoolExecutor(3) as pool:
        places = [begin(pool, text, each, air, real_time=True, until=7_000_000_000) for each in ("one", "two", "three")]
        time.sleep(2)
        air.cut_to = {"two"}
        time.sleep(2)
        air.restore()
        found = [each.result(60) for each in places]
    assert [run.outcome.ended for run in found] == ["time limit"] * 3
