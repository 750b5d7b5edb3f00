"""How long a place may be silent before it is lost, and how much places send that have nothing to say; in simulated
time, so that a busy machine makes no difference.
"""

from __future__ import annotations

from collections.abc import Callable

import pytest

from cspdiag.simulate.hosts import links as links_module
from cspdiag.simulate.hosts.links import PATIENCE, Link, Links
from cspdiag.simulate.hosts.messages import Codec

STEP = 10_000_000
DELAY = 2
"""Steps that a frame is on its way."""


class Pair:
    """Two places with a link, which has nothing to bring, and their time: ``monotonic`` and ``monotonic_ns``."""

    def __init__(self) -> None:
        self.now = 1_000_000_000
        self.steps = 0
        self.count = 0
        """The number of frames that were sent."""
        self.cut_to: tuple[str, ...] = ()
        """Places that nothing reaches."""
        self._under_way: list[tuple[int, str, bytes]] = []
        self.links = {
            place: Links(self, Codec(None), place, [other], {})
            for place, other in (("left", "right"), ("right", "left"))
        }

    def monotonic(self) -> float:
        return self.now / 1e9

    def monotonic_ns(self) -> int:
        return self.now

    def open(self, place: str, arrived: Callable[[bytes], None]) -> None:
        """See ``Transport.open``; the links are stepped by the test, not opened."""

    def close(self) -> None:
        """See ``open``."""

    def send(self, place: str, data: bytes) -> None:
        self.count += 1
        if place not in self.cut_to:
            self._under_way.append((self.steps + DELAY, place, data))

    def ends(self) -> tuple[Link, Link]:
        return self.links["left"].by_place["right"], self.links["right"].by_place["left"]

    def step(self) -> None:
        self.now += STEP
        self.steps += 1
        while self._under_way and self._under_way[0][0] <= self.steps:
            _, place, data = self._under_way.pop(0)
            self.links[place]._arrived(data)
        if self.steps % 2 == 0:
            for links in self.links.values():
                for link in links.by_place.values():
                    with links._changed:
                        links._keep_up_with(link, self.monotonic())

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds * 1e9 / STEP)):
            self.step()

    def run_until(self, condition: Callable[[], bool], limit: float) -> float:
        """The seconds until something is true."""
        began = self.now
        while not condition():
            self.step()
            assert self.now - began < limit * 1e9
        return (self.now - began) / 1e9


@pytest.fixture
def pair(monkeypatch: pytest.MonkeyPatch) -> Pair:
    pair = Pair()
    monkeypatch.setattr(links_module, "time", pair)
    pair.run_until(lambda: not any(links.missing for links in pair.links.values()), 1)
    for links in pair.links.values():
        links.begun = True
    pair.run(0.3)
    return pair


directions = pytest.mark.parametrize("to", [("left", "right"), ("left",), ("right",)], ids=["both", "left", "right"])


@directions
def test_a_pause_that_is_shorter_than_a_second_loses_no_place(pair: Pair, to: tuple[str, ...]) -> None:
    for number in range(20):
        pair.cut_to = to
        pair.run(0.99 * PATIENCE)
        pair.cut_to = ()
        pair.run(0.3 + 0.01 * number)
    assert [link.losses for link in pair.ends()] == [0, 0]


@directions
def test_a_silent_place_is_lost_after_a_second_for_both(pair: Pair, to: tuple[str, ...]) -> None:
    for number in range(10):
        pair.cut_to = to
        first = pair.run_until(lambda: any(link.lost for link in pair.ends()), 2)
        assert first >= PATIENCE
        assert first + pair.run_until(lambda: all(link.lost for link in pair.ends()), 2) <= 1.6
        pair.cut_to = ()
        assert pair.run_until(lambda: not any(link.lost for link in pair.ends()), 2) <= 0.7
        pair.run(0.3 + 0.01 * number)


def test_places_that_have_nothing_to_say_send_few_frames(pair: Pair) -> None:
    before = pair.count
    pair.run(2)
    assert 16 <= pair.count - before <= 44
