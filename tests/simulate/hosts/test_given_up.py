"""Writers that give up while their link is away: the readers get none of their values later."""

from __future__ import annotations

import time
from concurrent.futures import ThreadPoolExecutor
from typing import cast

import pytest

from cspdiag.simulate.result import Run
from tests.simulate.hosts.places import Air, begin, eventually

SECOND = 1_000_000_000
PROGRAM = """
process Source {
  out sent     : int
  out written  : int @ 10 ms safe -1
  out given_up : int @ 10 ms safe -1
  communication { var n : int = 0 }
  composition {
    mu (wait 15 ms ; n := n + 1 ; written ! n ; ((sent ! n) GIVES_UP -> given_up ! n) catch Timeout -> given_up ! n)
  }
}

process Sink {
  in  received : int
  out value    : int @ 10 ms safe -1
  communication { var n : int = 0 }
  composition { mu ((TAKES) catch Timeout -> skip) }
}

process Both {
  out written, given_up, value : int @ 10 ms safe -1
  communication {
    source : Source
    sink   : Sink
    source.sent     -> sink.received
    source.written  -> written
    source.given_up -> given_up
    sink.value      -> value
  }
  composition { source || sink }
}

environment Bench for Both step 10 ms on miss count place left : source place right : sink {
  written -> _  given_up -> _  value -> _
}
"""
READS = "received ? n ; value ! n"
CHOOSES = "received ? n -> value ! n [] after 5 s -> value ! -5"
AWAY = 2.5
"""Seconds for which the link is away."""


def _program(gives_up: str = "catch Timeout", takes: str = READS) -> str:
    return PROGRAM.replace("GIVES_UP", gives_up).replace("TAKES", takes)


def _run(text: str, air: Air, *, away: float, cut_to: str = "") -> tuple[Run, Run]:
    """The runs of the source and of the sink; the link is away for a part of the time."""
    with ThreadPoolExecutor() as pool:
        places = [
            begin(pool, text, place, air, real_time=True, until=int((2 + away) * SECOND)) for place in ("left", "right")
        ]
        assert eventually(lambda: air.count > 40)
        if cut_to:
            air.cut_to.add(cut_to)
        else:
            air.is_cut = True
        time.sleep(away)
        air.restore()
        source, sink = (place.result(timeout=30) for place in places)
    assert (source.outcome.ended, sink.outcome.ended) == ("time limit", "time limit")
    return source, sink


def _values(run: Run, channel: str) -> dict[int, float]:
    """The values that have passed a channel, which are whole numbers, with their instants in seconds."""
    passed = ((cast("int", value), at) for at, name, value, *_ in run.communications if name == channel)
    return {value: at / SECOND for value, at in passed}


def _check(source: Run, sink: Run, *, oldest: float, given_up: int, taken_nevertheless: int = 1) -> None:
    written, abandoned = _values(source, "Both.written"), _values(source, "Both.given_up")
    taken = _values(sink, "Both.source.sent")
    assert len(abandoned) >= given_up
    assert max(taken) > max(abandoned)  # The link has come back.
    # A busy machine may acknowledge a value just after it was given up, any number of times.
    long_given_up = [value for value in {*taken} & {*abandoned} if taken[value] - abandoned[value] > 0.2]
    assert len(long_given_up) <= taken_nevertheless
    assert set(written) - set(taken) - set(abandoned) <= {max(written)}  # All others have arrived.
    assert max(at - written[value] for value, at in taken.items()) < oldest


@pytest.mark.parametrize("keeps", [False, True], ids=["lost", "kept"])
@pytest.mark.parametrize("takes", [READS, CHOOSES], ids=["reader", "alternative"])
def test_what_timed_out_is_not_taken_when_the_link_is_back(keeps: bool, takes: str) -> None:
    air = Air()
    air.keeps = keeps
    source, sink = _run(_program(takes=takes), air, away=AWAY)
    _check(source, sink, oldest=1.6, given_up=5)


@pytest.mark.parametrize("place", ["left", "right"])
def test_a_link_that_is_lost_in_one_direction_is_lost_for_both(place: str) -> None:
    air = Air()
    air.keeps = True
    source, sink = _run(_program(), air, away=AWAY, cut_to=place)
    _check(source, sink, oldest=1.6, given_up=5)
    # On a busy machine perhaps more than once.
    assert ["lost " in run.outcome.links[0] for run in (source, sink)] == [True, True]


def test_what_an_interrupt_abandoned_is_not_taken_when_the_link_is_back() -> None:
    air = Air()
    air.keeps = True
    source, sink = _run(_program("interrupt after 30 ms"), air, away=0.7)  # Shorter than a loss.
    # Once when the link went away, and once when it was not back yet in both directions.
    _check(source, sink, oldest=1.0, given_up=10, taken_nevertheless=2)


def test_a_reader_that_comes_late_does_not_take_what_was_offered_before_the_link_was_lost() -> None:
    air = Air()
    source, sink = _run(_program(takes="wait 300 ms ; received ? n ; value ! n"), air, away=AWAY)
    _check(source, sink, oldest=1.6, given_up=1)
