"""Delays: the order in which they end, with and without ticks in between, and those that are cancelled."""

from __future__ import annotations

from typing import Any

import pytest

from cspdiag.runtime import Network, Process, SampledInput, Steps, Task, begin_delay, ms, now, parallel, wait
from cspdiag.runtime.kernel.timers import Timers
from tests.runtime.compiled.programs import Body, failing, run
from tests.runtime.support import Scripted


class _Timer:
    def __init__(self, name: str, fallen: list[str], *stopped: _Timer) -> None:
        self.name = name
        self.fallen = fallen
        self.stopped = stopped
        self.timers = Timers()

    def due(self) -> None:
        self.fallen.append(self.name)
        for other in self.stopped:
            self.timers.stop(5, other)


def test_timers_of_one_instant_fall_due_in_the_order_of_their_beginning() -> None:
    timers, fallen = Timers(), list[str]()
    for name in "abc":
        timers.begin(5, _Timer(name, fallen))
    timers.begin(3, _Timer("first", fallen))
    assert sorted(timers.instants()) == [3, 5, 5, 5]
    while (instant := timers.next_instant()) is not None:
        timers.fall_due(instant)
    assert fallen == ["first", "a", "b", "c"]


def test_a_timer_stops_others_of_its_instant() -> None:
    fallen = list[str]()
    last = _Timer("last", fallen)
    middle = _Timer("middle", fallen)
    first = _Timer("first", fallen, middle)
    for timer in (first, middle, last):
        first.timers.begin(5, timer)
    first.timers.fall_due(5)
    assert fallen == ["first", "last"]
    assert first.timers.next_instant() is None


@pytest.mark.parametrize("count", [1, 2])
def test_an_instant_whose_timers_were_stopped_can_be_used_again(count: int) -> None:
    timers, fallen = Timers(), list[str]()
    stopped = [_Timer("stopped", fallen) for _ in range(count)]
    for timer in stopped:
        timers.begin(5, timer)
    timers.begin(7, _Timer("later", fallen))
    assert [timers.stop(5, timer) for timer in stopped] == [True] * count
    assert [timers.stop(5, timer) for timer in stopped] == [False] * count
    assert timers.next_instant() == 7
    timers.begin(5, _Timer("again", fallen))
    instants = []
    while (instant := timers.next_instant()) is not None:
        instants.append(instant)
        timers.fall_due(instant)
    assert (instants, fallen) == ([5, 7], ["again", "later"])


def sleeping(name: str, trace: list[tuple[int, str]], *delays: int) -> Body:
    def steps(me: Task) -> Steps:
        for delay in delays:
            begin_delay(me, delay)
            yield
            trace.append((me.scheduler.now, name))

    return steps


def test_delays_end_in_order_of_their_instants_and_then_of_their_beginning() -> None:
    trace = list[tuple[int, str]]()
    assert (
        run(sleeping("a", trace, 2, 2, 2), sleeping("b", trace, 3, 1, 2), sleeping("c", trace, 6)).ended == "terminated"
    )
    assert trace == [(2, "a"), (3, "b"), (4, "a"), (4, "b"), (6, "c"), (6, "a"), (6, "b")]


def test_a_branch_that_fails_after_a_delay_cancels_the_delays_of_the_others() -> None:
    trace = list[tuple[int, str]]()

    def failing_later(me: Task) -> Steps:
        begin_delay(me, 3)
        yield
        yield from failing("late")(me)

    outcome = run(sleeping("a", trace, 2, 2), failing_later, sleeping("b", trace, 10))
    assert (outcome.ended, outcome.time) == ("failed", 3)
    assert trace == [(2, "a")]


@pytest.mark.parametrize(("until", "seen"), [(5, [2, 4]), (6, [2, 4, 6]), (1, [])])
def test_no_delay_ends_after_the_time_limit(until: int, seen: list[int]) -> None:
    trace = list[tuple[int, str]]()
    outcome = run(sleeping("a", trace, *[2] * 100), until=until)
    assert (outcome.ended, outcome.time) == ("time limit", until)
    assert [time for time, _ in trace] == seen


class _Sleepers(Process):
    """Waits for samples and, in the other branch, for instants between, at and after them."""

    def __init__(self, angle: SampledInput[Any], trace: list[tuple[int, str]]) -> None:
        super().__init__("Sleepers")
        self.angle = angle.reader(self)
        self.trace = trace

    async def run(self) -> None:
        async def samples() -> None:
            for _ in range(3):
                value = await self.angle.read()
                self.trace.append((now(), f"sample {value}"))

        async def delays() -> None:
            for pause in (ms // 2, ms // 2, ms // 2, ms):
                await wait(pause)
                self.trace.append((now(), "delay"))

        await parallel(samples(), delays())


def test_delays_end_between_ticks_and_after_the_samples_of_their_own_instant() -> None:
    trace = list[tuple[int, str]]()
    environment = Scripted({"angle": {ms: 1, 2 * ms: 2, 3 * ms: 3}})
    angle = SampledInput[int]("angle", period=1 * ms, driver=environment.drivers["angle"])
    outcome = Network(_Sleepers(angle, trace), ports=(angle,)).run(environment)
    assert outcome.ended == "terminated"
    half = ms // 2
    assert trace == [
        (half, "delay"),
        (2 * half, "sample 1"),
        (2 * half, "delay"),
        (3 * half, "delay"),
        (4 * half, "sample 2"),
        (5 * half, "delay"),
        (6 * half, "sample 3"),
    ]
