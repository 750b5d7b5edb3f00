"""In virtual time the traces of all places together are that of one process, to the bit."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import pytest

import cspdiag
from cspdiag.simulate.result import Run
from tests.simulate.hosts.conftest import pair
from tests.simulate.hosts.places import Air, begin, trace

BROADCAST = """
process Source {
  out sent : int
  communication { var n : int = 0 }
  composition { mu (n := n + 1 ; sent ! n ; if n % 2 == 0 then wait 3 ms) until n == 9 }
}

process Sink(pause: time) {
  in  received : int
  in  level    : double @ 4 ms
  out value    : double @ 2 ms safe 0
  communication { var n : int = 0  var h : double = 0 }
  composition { mu (received ? n ; wait pause ; level ? h ; value ! double(n) * h) until n == 9 }
}

process Three {
  in  level : double @ 4 ms
  out u, v  : double @ 2 ms safe 0
  communication {
    source : Source
    near   : Sink(pause = 5 ms)
    far    : Sink(pause = 1 ms)
    source.sent -> broadcast -> near.received, far.received
    level       -> near.level, far.level
    near.value  -> u
    far.value   -> v
  }
  composition { source || near || far }
}

submodel Tank {
  in  inflow, more : double
  out level : double
  level = integral(inflow / 1<s> - 0.1<1/s> * more, 1.0)
}

environment Bench for Three step 2 ms on miss count place one : source, near place two : far {
  tank : Tank
  u          -> tank.inflow
  v          -> tank.more
  tank.level -> level
}
"""

CLOCK = """
exception Broken

process Clock {
  out tick : int
  communication { var n : int = 0 }
  composition { mu (wait 10 ms ; n := n + 1 ; tick ! n) until n == 5 }
}

process Watch {
  in tick : int
  communication { var n : int = 0  var late : int = 0 }
  composition { COMPOSITION }
}

process Both {
  communication {
    clock : Clock
    watch : Watch
    clock.tick -> watch.tick
  }
  composition { clock || watch }
}

environment Bench for Both place left : clock place right : watch { }
"""
TIME_OUT = CLOCK.replace("COMPOSITION", "mu (tick ? n -> skip [] after 4 ms -> late := late + 1) until n == 5")
INTERRUPT = CLOCK.replace("COMPOSITION", "mu ((mu wait 3 ms) interrupt tick ? n -> late := late + 1) until n == 5")
EXCEPTION = CLOCK.replace("COMPOSITION", "tick ? n ; wait 15 ms ; raise Broken")
WAITS = CLOCK.replace("COMPOSITION", "mu tick ? n until n == 9")


def _in_places(text: str, places: list[str], air: Air) -> list[Run]:
    with ThreadPoolExecutor() as pool:
        running = [begin(pool, text, place, air) for place in places]
        return [place.result(timeout=60) for place in running]


@pytest.mark.parametrize(
    ("text", "places"),
    [
        (pair(20), ["left", "right"]),
        (BROADCAST, ["one", "two"]),
        (TIME_OUT, ["left", "right"]),
        (INTERRUPT, ["left", "right"]),
        (EXCEPTION, ["left", "right"]),
        (WAITS, ["left", "right"]),
    ],
    ids=["rendezvous", "broadcast and plant", "time-out", "interrupt", "exception", "deadlock"],
)
def test_traces_are_those_of_one_process(text: str, places: list[str]) -> None:
    runs = _in_places(text, places, Air())
    whole = cspdiag.parse(text).run(level=0)
    assert trace(*runs) == trace(whole)
    assert trace(whole)
    for run in runs:
        assert (run.outcome.ended, run.outcome.time) == (whole.outcome.ended, whole.outcome.time)
        assert str(run.outcome.error) == str(whole.outcome.error)


def test_a_place_that_did_not_raise_names_the_process_that_did() -> None:
    left, _ = _in_places(EXCEPTION, ["left", "right"], Air())
    assert type(left.outcome.error).__name__ == "Broken"
    assert getattr(left.outcome.error, "place", None) == "Both.watch (program.csp:13)"


def test_messages_that_are_lost_or_late_change_nothing() -> None:
    runs = _in_places(pair(5), ["left", "right"], Air(loss=0.3, delay=0.01))
    assert trace(*runs) == trace(cspdiag.parse(pair(5)).run(level=0))
