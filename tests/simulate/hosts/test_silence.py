"""How long a place may be silent before it is lost, and how much places send that have nothing to say."""

from __future__ import annotations

import time
from collections.abc import Iterator

import pytest

from cspdiag.simulate.hosts.links import PATIENCE, Link, Links
from cspdiag.simulate.hosts.messages import Codec
from tests.simulate.hosts.places import Air, eventually


@pytest.fixture
def air() -> Air:
    return Air()


@pytest.fixture
def ends(air: Air) -> Iterator[tuple[Link, Link]]:
    """The two ends of a link, which has nothing to bring."""
    left = Links(air.transport(), Codec(None), "left", ["right"], {})
    right = Links(air.transport(), Codec(None), "right", ["left"], {})
    for links in (left, right):
        links.open()
    assert eventually(lambda: not left.missing and not right.missing)
    left.begun = right.begun = True
    time.sleep(0.3)
    yield left.by_place["right"], right.by_place["left"]
    for links in (left, right):
        links.close()


@pytest.mark.parametrize("to", [("left", "right"), ("left",), ("right",)], ids=["both", "left", "right"])
def test_a_pause_that_is_shorter_than_a_second_loses_no_place(
    air: Air, ends: tuple[Link, Link], to: tuple[str, ...]
) -> None:
    for _ in range(4):
        air.cut_to.update(to)
        time.sleep(0.92 * PATIENCE)
        air.cut_to.clear()
        time.sleep(0.37)
    assert [link.losses for link in ends] == [0, 0]


@pytest.mark.parametrize("to", [("left", "right"), ("left",), ("right",)], ids=["both", "left", "right"])
def test_a_silent_place_is_lost_after_a_second_for_both(air: Air, ends: tuple[Link, Link], to: tuple[str, ...]) -> None:
    for _ in range(3):
        began = time.monotonic()
        air.cut_to.update(to)
        assert eventually(lambda: any(link.lost for link in ends), 3)
        assert time.monotonic() - began > PATIENCE - 0.03
        assert eventually(lambda: all(link.lost for link in ends), 1)
        assert time.monotonic() - began < 1.8  # 1.3 s, unless the machine is busy.
        air.cut_to.clear()
        assert eventually(lambda: not any(link.lost for link in ends), 1)


def test_places_that_have_nothing_to_say_send_few_frames(air: Air, ends: tuple[Link, Link]) -> None:
    before = air.count
    time.sleep(2)
    assert 16 <= air.count - before <= 44
