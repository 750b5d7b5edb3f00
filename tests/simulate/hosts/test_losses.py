"""Places that cannot be found, do not fit, or fall silent."""

from __future__ import annotations

import re
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from types import ModuleType

import pytest

from cspdiag.simulate.hosts import part as gathering
from cspdiag.simulate.hosts import run as runs
from cspdiag.simulate.hosts.links import LONGEST_SILENCE, Links, PlaceError
from cspdiag.simulate.hosts.messages import Codec
from tests.simulate.hosts.conftest import pair
from tests.simulate.hosts.places import Air, begin, eventually, run_place

SECOND = 1_000_000_000
ALONE = """
process Hold { out u : double @ 10 ms safe 3  composition { mu (u ! 1 ; wait 10 ms) } }
process Two {
  out u, v  : double @ 10 ms safe 3
  communication { a : Hold  b : Hold  a.u -> u  b.u -> v }
  composition { a || b }
}
environment Bench for Two place left : a place right : b { u -> _  v -> _ }
"""
CAUGHT = "catch Timeout -> (timeouts := timeouts + 1 ; value ! -timeouts)"


def test_a_place_that_no_process_has(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gathering, "GATHERING", 0.3)
    with pytest.raises(
        PlaceError, match=r"no process has the place `right` after 0.3 s: start one with --place right@"
    ):
        run_place(pair(5), "left", Air())


def test_a_place_that_the_environment_does_not_have() -> None:
    with pytest.raises(PlaceError, match="the environment `Bench` has no place `middle`; it has `left`, `right`"):
        run_place(pair(5), "middle", Air())


def test_different_programs_are_refused_by_both() -> None:
    air = Air()
    with ThreadPoolExecutor() as pool:
        places = [
            begin(pool, pair(5), place, air, program={"program": digest, "time limit": limit})
            for place, digest, limit in (("left", "1", "5s"), ("right", "2", "5s"))
        ]
        for place in places:
            with pytest.raises(
                PlaceError, match=r"the place `(left|right)` has another program; start all places with"
            ):
                place.result(timeout=30)


def test_different_options_are_shown() -> None:
    air = Air()
    with ThreadPoolExecutor() as pool:
        left = begin(pool, pair(5), "left", air, program={"program": "1", "time limit": "5s"})
        right = begin(pool, pair(5), "right", air, program={"program": "1", "time limit": "7s"})
        with pytest.raises(PlaceError, match="another time limit: here 5s, there 7s"):
            left.result(timeout=30)
        with pytest.raises(PlaceError, match="another time limit: here 7s, there 5s"):
            right.result(timeout=30)


def test_the_second_process_with_a_place_is_refused_and_the_first_continues() -> None:
    air = Air()
    with ThreadPoolExecutor() as pool:
        first = begin(pool, pair(200), "left", air)
        partner = begin(pool, pair(200), "right", air)
        second = begin(pool, pair(200), "left", air)
        results = [first.exception(timeout=60), second.exception(timeout=60)]
        refused = [error for error in results if error is not None]
        assert len(refused) == 1
        assert re.search(r"another process (has|in) the place `left`", str(refused[0]))
        assert partner.result(timeout=60).outcome.ended == "terminated"


def three_places() -> str:
    """A third process beside those of ``ALONE``, in a place of its own."""
    text = ALONE.replace("b : Hold", "b : Hold  c : Hold").replace("a || b", "a || b || c")
    text = text.replace("u, v  :", "u, v, w :").replace("v -> _", "v -> _  w -> _")
    return text.replace("b.u -> v", "b.u -> v  c.u -> w").replace("right : b", "right : b place top : c")


def test_a_process_that_has_ended_before_the_run_began_can_be_replaced() -> None:
    text = three_places()
    air = Air()
    abandoned = Links(air.transport(), Codec(None), "left", ["right", "top"], {})
    abandoned.open()
    with ThreadPoolExecutor() as pool:
        right = begin(pool, text, "right", air, until=SECOND // 50)
        assert eventually(lambda: abandoned.missing == ["top"])
        abandoned.close()
        time.sleep(LONGEST_SILENCE + 0.2)
        places = [begin(pool, text, place, air, until=SECOND // 50) for place in ("left", "top")]
        assert [place.result(timeout=30).outcome.ended for place in (*places, right)] == ["time limit"] * 3


def test_a_place_that_cannot_start_reports_it_to_those_that_it_has_found() -> None:
    text, air = three_places(), Air()
    top = Links(air.transport(), Codec(None), "top", ["left", "right"], {"program": "1"})
    top.open()
    with ThreadPoolExecutor() as pool:
        left = begin(pool, text, "left", air, program={"program": "1"})
        assert eventually(lambda: top.missing == ["right"])
        begin(pool, text, "right", air, program={"program": "2"})
        reason = str(left.exception(timeout=20))
    assert reason == "the place `right` has another program; start all places with the same files and options"
    assert list(top.inbox) == [("left", ("bye", "failed", "left", reason))]
    top.close()


def test_a_place_gives_up_when_another_reports_that_the_run_cannot_start() -> None:
    text, air = three_places(), Air()
    left = Links(air.transport(), Codec(None), "left", ["top", "right"], {})
    left.open()
    with ThreadPoolExecutor() as pool:
        top = begin(pool, text, "top", air)
        assert eventually(lambda: left.missing == ["right"])
        left.broadcast(("bye", "failed", "left", "the place `right` has another program"))
        with pytest.raises(PlaceError, match="the place `left` has ended: the place `right` has another program"):
            top.result(timeout=20)
    left.close()


def test_a_process_that_was_started_again_learns_that_the_run_has_begun() -> None:
    air = Air()
    with ThreadPoolExecutor() as pool:
        left, right = (begin(pool, pair(300), place, air, real_time=True) for place in ("left", "right"))
        assert eventually(lambda: air.count > 100)
        again = begin(pool, pair(300), "left", air, real_time=True)
        with pytest.raises(PlaceError, match="the run has begun with another process in the place `left`, which none"):
            again.result(timeout=20)
        assert [place.result(timeout=60).outcome.ended for place in (left, right)] == ["terminated", "terminated"]


def test_places_that_know_each_other_do_not_repeat_what_they_run() -> None:
    air, frames = Air(), list[bytes]()
    program = {"program": "the digest of all that is generated"}
    left = Links(air.transport(), Codec(None), "left", ["right"], program)
    right = Links(air.transport(), Codec(None), "right", ["left"], program)
    left.open()
    right.open()
    assert eventually(lambda: not left.missing and not right.missing)
    air.join("right", frames.append)
    assert eventually(lambda: len(frames) > 3)
    left.close()
    right.close()
    assert b"the digest" not in b"".join(frames[1:])  # The first was perhaps on its way.


def test_a_lost_link_raises_a_time_out_that_can_be_caught_and_comes_back() -> None:
    air = Air()
    with ThreadPoolExecutor() as pool:
        left = begin(pool, pair(150), "left", air, real_time=True)
        right = begin(pool, pair(150, CAUGHT), "right", air, real_time=True)
        assert eventually(lambda: air.count > 100)
        air.is_cut = True
        assert not eventually(lambda: left.done() or right.done(), 1.6)
        air.is_cut = False
        sink, source = right.result(timeout=30), left.result(timeout=30)
    assert (sink.outcome.ended, source.outcome.ended) == ("terminated", "terminated")
    values = [value for _, channel, value, _, _ in sink.communications if channel == "Pair.value"]
    assert min(values) < 0  # It got Timeout while the link was cut,
    assert sink["Pair.source.sent"][-1][0] == 150  # and all that comes afterwards.
    counted = [value for value in values if value > 0]
    assert counted == sorted(set(counted))  # Nothing twice.
    assert "lost 1 time" in sink.outcome.links[0]


def test_a_lost_link_that_nobody_catches_ends_the_run_and_releases_the_outputs() -> None:
    air = Air()
    with ThreadPoolExecutor() as pool:
        left = begin(pool, pair(100_000).replace("catch Timeout -> wait 1 ms", ""), "left", air, real_time=True)
        right = begin(pool, pair(100_000), "right", air, real_time=True)
        assert eventually(lambda: air.count > 100)
        air.is_cut = True
        sink, source = right.result(timeout=30), left.result(timeout=30)
    for run in (sink, source):
        assert run.outcome.ended == "failed"
        assert "has been silent for 1 s" in str(run.outcome.error)
    assert [(port, value) for _, port, value in sink.releases] == [("Pair.value", 7)]
    assert list(source.releases) == []


def test_places_without_channels_between_them_end_together_as_well(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(runs, "SILENCE", 2.5)
    air = Air()
    with ThreadPoolExecutor() as pool:
        left = begin(pool, ALONE, "left", air, real_time=True)
        right = begin(pool, ALONE, "right", air, real_time=True)
        assert eventually(lambda: air.count > 60)
        air.is_cut = True
        assert not eventually(lambda: left.done() or right.done(), 1.6)
        air.is_cut = False  # A short loss matters to nobody.
        assert not eventually(lambda: left.done() or right.done(), 1.6)
        air.is_cut = True
        results = [left.result(timeout=30), right.result(timeout=30)]
    assert [run.outcome.ended for run in results] == ["failed", "failed"]
    assert ["has been silent for 2.5 s" in str(run.outcome.error) for run in results] == [True, True]
    assert [port for run in results for _, port, _ in run.releases] == ["Two.u", "Two.v"]


def test_in_virtual_time_a_silent_place_ends_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(runs, "SILENCE", 1.2)
    air = Air()
    with ThreadPoolExecutor() as pool:
        places = [begin(pool, pair(100_000), place, air) for place in ("left", "right")]
        assert eventually(lambda: air.count > 100)
        air.is_cut = True
        for place in places:
            outcome = place.result(timeout=30).outcome
            assert outcome.ended == "failed"
            assert "has been silent for 1.2 s" in str(outcome.error)


def test_a_place_that_fails_ends_the_others() -> None:
    text = pair(100_000).replace("value ! order.count", "value ! 100 / (order.count - 3)")
    air = Air()
    with ThreadPoolExecutor() as pool:
        left = begin(pool, text, "left", air, real_time=True)
        right = begin(pool, text, "right", air, real_time=True)
        outcomes = [left.result(timeout=30).outcome, right.result(timeout=30).outcome]
    assert ["division by zero" in str(outcome.error) for outcome in outcomes] == [True, True]


def test_all_places_end_with_the_reason_of_the_first_one() -> None:
    air = Air()
    top = Links(air.transport(), Codec(None), "top", ["left", "right"], {})
    top.open()
    with ThreadPoolExecutor() as pool:
        left, right = (begin(pool, three_places(), place, air, real_time=True) for place in ("left", "right"))
        assert eventually(lambda: not top.missing)
        top.begun = True
        top.broadcast(("ready",))
        assert eventually(lambda: len(top.inbox) > 3)
        top.send("left", ("bye", "failed", "bottom", "a reason"))  # As one place more would have reported to it.
        outcomes = [place.result(timeout=30).outcome for place in (left, right)]
        assert eventually(lambda: len([each for each in top.inbox if each[1][0] == "bye"]) == 2)
    assert [str(outcome.error) for outcome in outcomes] == ["the place `bottom` has ended: a reason"] * 2
    assert {each for each in top.inbox if each[1][0] == "bye"} == {
        (place, ("bye", "failed", "bottom", "a reason")) for place in ("left", "right")
    }
    top.close()


def test_a_message_is_sent_again_after_the_package_of_the_program_has_gone(monkeypatch: pytest.MonkeyPatch) -> None:
    types = ModuleType("_package_that_goes.types")
    exec("from enum import Enum\nclass Order(Enum):\n    GO = 1", types.__dict__)
    order = types.__dict__["Order"].GO
    monkeypatch.setitem(sys.modules, "_package_that_goes", ModuleType("_package_that_goes"))
    monkeypatch.setitem(sys.modules, types.__name__, types)
    air = Air()
    left, right = (
        Links(air.transport(), Codec(types), *places, {}) for places in (("left", ["right"]), ("right", ["left"]))
    )
    left.open()
    right.open()
    assert eventually(lambda: not left.missing and not right.missing)
    air.is_cut = True
    left.send("right", order)
    monkeypatch.undo()
    sent = air.count
    assert eventually(lambda: air.count > sent + 3)
    air.is_cut = False
    assert eventually(lambda: not left.by_place["right"].waiting)
    left.close()
    right.close()
    assert list(right.inbox) == [("left", order)]
