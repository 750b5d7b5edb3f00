"""A run that ends inside another, or at the same time in another thread, leaves the signals to the other run."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable

import pytest

from cspdiag.runtime import EventOutput, Network
from tests.runtime.support import Body


class _Lamp:
    """A device: a run that drives one handles the signals of the process."""

    def write(self, value: int) -> None:
        pass


def _run_inside() -> None:
    async def nothing() -> None:
        pass

    lamp = EventOutput[int]("inner", driver=_Lamp(), safe=0)
    for ports in ([], [lamp]):
        assert Network(Body(nothing), ports).run().ended == "terminated"


def _run_beside() -> None:
    thread = threading.Thread(target=_run_inside)
    thread.start()
    thread.join(20)


@pytest.mark.parametrize("other", [_run_inside, _run_beside])
def test_another_run_that_ends_keeps_no_signal_from_a_run(other: Callable[[], None]) -> None:
    heard: list[int] = []
    during: list[int] = []

    async def program() -> None:
        other()
        signal.raise_signal(signal.SIGUSR1)
        during.extend(heard)

    before = signal.signal(signal.SIGUSR1, lambda number, _: heard.append(number))
    try:
        outcome = Network(Body(program), [EventOutput[int]("outer", driver=_Lamp(), safe=0)]).run()
    finally:
        signal.signal(signal.SIGUSR1, before)
    assert outcome.ended == "terminated"
    assert during == [signal.SIGUSR1]


def test_a_signal_stops_the_run_around_one_that_has_ended() -> None:
    async def program() -> None:
        _run_inside()
        signal.raise_signal(signal.SIGTERM)

    outcome = Network(Body(program), [EventOutput[int]("outer", driver=_Lamp(), safe=0)]).run()
    assert (outcome.ended, outcome.signal) == ("stopped", signal.SIGTERM)
