"""In real time places begin and end together, however long the messages between some of them take."""

from __future__ import annotations

import pickle
import threading
from concurrent.futures import ThreadPoolExecutor

from tests.simulate.hosts.places import Air, begin

CHAIN = """
process Source {
  out sent : int
  communication { var n : int = 0 }
  composition { mu (n := n + 1 ; sent ! n) until n == 3 }
}

process Between {
  in  received : int
  out sent     : int
  communication { var n : int = 0 }
  composition { mu (received ? n ; sent ! n) until n == 3 }
}

process Sink {
  in  received : int
  communication { var n : int = 0 }
  composition { mu received ? n until n == 3 }
}

process Chain {
  communication {
    source  : Source
    between : Between
    sink    : Sink
    source.sent  -> between.received
    between.sent -> sink.received
  }
  composition { source || between || sink }
}

environment Bench for Chain step 10 ms place one : source place two : between place three : sink { }
"""


class SlowFrom(Air):
    """What one place sends to another one takes longer than everything else."""

    def __init__(self, sender: str, receiver: str, delay: float) -> None:
        super().__init__()
        self._slow = sender, receiver, delay

    def send(self, place: str, data: bytes) -> None:
        """See ``Air.send``."""
        sender, receiver, delay = self._slow
        if place == receiver and pickle.loads(data)[0] == sender:
            timer = threading.Timer(delay, super().send, [place, data])
            timer.daemon = True
            timer.start()
        else:
            super().send(place, data)


def test_what_arrives_before_the_last_place_has_begun_is_not_lost() -> None:
    air = SlowFrom("three", "two", 0.3)
    with ThreadPoolExecutor(3) as pool:
        places = [
            begin(pool, CHAIN, place, air, real_time=True, until=8_000_000_000) for place in ("one", "two", "three")
        ]
        runs = [place.result(60) for place in places]
    assert [run.outcome.ended for run in runs] == ["terminated"] * 3


def test_a_place_whose_clock_is_behind_comes_to_the_time_limit_as_the_others_have() -> None:
    forever = CHAIN.replace("mu (n := n + 1", "wait 1 min ; mu (n := n + 1")
    limits = {"one": 500_000_000, "two": 800_000_000, "three": 800_000_000}
    air = Air()
    with ThreadPoolExecutor(3) as pool:
        places = [begin(pool, forever, place, air, real_time=True, until=until) for place, until in limits.items()]
        runs = [place.result(60) for place in places]
    assert [run.outcome.ended for run in runs] == ["time limit"] * 3
