"""Sampled and event ports in virtual time, against scripted environments."""

from __future__ import annotations

import math
import signal
from typing import Any

import pytest

from cspdiag.runtime import (
    Alternative,
    EventInput,
    EventOutput,
    Fault,
    Input,
    Network,
    Process,
    Ready,
    SampledInput,
    SampledOutput,
    Timeout,
    ms,
    parallel,
    read_all,
    us,
    wait,
    write_all,
)
from tests.runtime.support import Body, Scripted, Trace

COUNT = {k * ms: k for k in range(1000)}


def test_the_first_read_waits_for_the_next_tick_and_then_each_sample_is_taken() -> None:
    world = Scripted({"x": COUNT})
    port = SampledInput[int]("x", period=2 * ms, driver=world.drivers["x"])
    taken: list[tuple[int, int]] = []

    async def top() -> None:
        await wait(3 * ms)
        end = port.reader()
        for _ in range(3):
            taken.append((network.now, await end.read()))

    network = Network(Body(top), [port])
    network.run(world, until=100 * ms)
    assert taken == [(3 * ms, 4), (4 * ms, 6), (6 * ms, 8)]


def test_a_sample_of_this_very_instant_is_not_the_first_one_read() -> None:
    world = Scripted({"x": COUNT})
    port = SampledInput[int]("x", period=ms, driver=world.drivers["x"])
    taken: list[int] = []

    async def top() -> None:
        await wait(2 * ms)
        taken.append(await port.reader().read())

    Network(Body(top), [port]).run(world, until=100 * ms)
    assert taken == [3]


@pytest.mark.parametrize("on_miss", ["timeout", "count"])
def test_a_sample_overwritten_untaken_is_a_missed_deadline(on_miss: Any) -> None:
    world = Scripted({"x": COUNT})
    port = SampledInput[int]("x", period=ms, driver=world.drivers["x"])
    end = port.reader()
    log: list[object] = []

    async def top() -> None:
        log.append(await end.read())
        await wait(3500 * us)
        for _ in range(2):
            try:
                log.append(await end.read())
            except Timeout:
                log.append("timeout")

    outcome = Network(Body(top), [port]).run(world, on_miss=on_miss, until=100 * ms)
    assert outcome.missed == {"x": 2}
    assert log == ([1, "timeout", 4] if on_miss == "timeout" else [1, 4, 5])


def test_every_end_takes_every_sample_and_has_a_session_of_its_own() -> None:
    world = Scripted({"x": COUNT})
    port = SampledInput[int]("x", period=ms, driver=world.drivers["x"])
    taken: dict[str, list[int]] = {"a": [], "b": []}

    class Reader(Process):
        def __init__(self, name: str, count: int) -> None:
            super().__init__(name)
            self.x = port.reader(self)
            self.count = count

        async def run(self) -> None:
            for _ in range(self.count):
                taken[self.name].append(await self.x.read())

    a, b = Reader("a", 2), Reader("b", 4)

    async def top() -> None:
        await parallel(a, b)
        await wait(5 * ms)
        await a

    outcome = Network(Body(top), [port]).run(world, until=100 * ms)
    assert outcome.ended == "terminated"
    assert outcome.missed == {"x": 0}
    assert taken == {"a": [1, 2, 10, 11], "b": [1, 2, 3, 4]}


def test_a_guard_on_a_sampled_input_begins_its_session() -> None:
    world = Scripted({"x": COUNT, "button": {0: 0, 3 * ms: 2}})
    x = SampledInput[int]("x", period=ms, driver=world.drivers["x"])
    button = EventInput[int]("button", driver=world.drivers["button"])
    log: list[object] = []

    class Servo(Process):
        def __init__(self) -> None:
            super().__init__("servo")
            self.x = x.reader(self)
            self.button = button.reader(self)
            self.choice = Alternative(Input(self.button), Ready(self.x), prioritized=True)

        async def run(self) -> None:
            while True:
                match await self.choice.select():
                    case 0:
                        log.append(("button", self.choice.value))
                        return
                    case _:
                        log.append(await read_all(self.x))

    servo = Servo()

    async def top() -> None:
        await servo
        await wait(10 * ms)
        await parallel(servo, wait(2 * ms), stop_later())

    async def stop_later() -> None:
        await wait(2 * ms)
        raise KeyError("enough")

    Network(Body(top), [x, button]).run(world, until=100 * ms)
    assert log == [(1,), (2,), ("button", 2), (14,)] or log == [(1,), (2,), ("button", 2), (14,), (15,)]


def test_outputs_change_at_the_ticks_with_the_last_value_of_the_period() -> None:
    world = Scripted({}, ["u", "fast"])
    latched = SampledOutput[float]("u", period=2 * ms, driver=world.drivers["u"], safe=-1.0)
    immediate = SampledOutput[float]("fast", period=2 * ms, driver=world.drivers["fast"], immediate=True)

    async def top() -> None:
        await write_all((latched, 1.0), (immediate, 1.0))
        await wait(ms)
        await write_all((latched, 2.0), (immediate, 2.0))
        await wait(2500 * us)
        await latched.write(3.0)
        await wait(4 * ms)
        await latched.write(4.0)

    outcome = Network(Body(top), [latched, immediate]).run(world, until=100 * ms)
    assert outcome.time == 7500 * us
    assert world.written["u"] == [(2 * ms, 2.0), (4 * ms, 3.0), (7 * ms, -1.0)]
    assert world.written["fast"] == [(0, 1.0), (1 * ms, 2.0)]


def test_at_an_instant_inputs_precede_outputs_and_outputs_precede_delays() -> None:
    world = Scripted({"a": COUNT, "b": COUNT}, ["u"])
    b = SampledInput[int]("b", period=ms, driver=world.drivers["b"])
    a = EventInput[int]("a", driver=world.drivers["a"])
    u = SampledOutput[int]("u", period=ms, driver=world.drivers["u"])
    log: list[str] = []

    async def reads(name: str, end: Any) -> None:
        await end.read()
        log.append(name)

    async def delayed() -> None:
        await wait(ms)
        log.append("delay")

    async def top() -> None:
        await u.write(5)
        await parallel(delayed(), reads("a", a.reader()), reads("b", b.reader()))

    trace = Trace()
    Network(Body(top), [b, u, a]).run(world, observer=trace, until=100 * ms)
    assert log == ["b", "a", "delay"]
    assert [channel for _, channel, _ in trace.communications] == ["u", "b", "a"]


def test_an_event_is_kept_until_it_is_read_and_the_latest_wins() -> None:
    world = Scripted({"e": {0: 0, 2 * ms: 1, 3 * ms: 2, 9 * ms: 3}})
    port = EventInput[int]("e", driver=world.drivers["e"])
    taken: list[tuple[int, int]] = []

    async def top() -> None:
        await wait(5 * ms)
        for _ in range(2):
            value = await port.reader().read()
            taken.append((network.now, value))

    network = Network(Body(top), [port])
    network.run(world, until=100 * ms)
    assert taken == [(5 * ms, 2), (9 * ms, 3)]


@pytest.mark.parametrize(("kind", "expected"), [("broadcast", [1, 1]), ("any", [1, 2])])
def test_parallel_readers_of_an_event(kind: Any, expected: list[int]) -> None:
    world = Scripted({"e": {0: 0, 2 * ms: 1, 3 * ms: 2}})
    port = EventInput[int]("e", driver=world.drivers["e"], kind=kind)
    taken: list[int] = []

    async def reads() -> None:
        taken.append(await port.reader().read())

    async def top() -> None:
        await parallel(reads(), reads())

    assert Network(Body(top), [port]).run(world, until=100 * ms).ended == "terminated"
    assert taken == expected


def test_an_event_output_goes_to_its_driver_at_once() -> None:
    world = Scripted({}, ["lamp"])
    lamp = EventOutput[bool]("lamp", driver=world.drivers["lamp"], safe=False)

    async def top() -> None:
        await wait(ms)
        await lamp.write(True)

    Network(Body(top), [lamp]).run(world, until=100 * ms)
    assert world.written["lamp"] == [(0, True), (0, False)] or world.written["lamp"] == [(ms, True), (ms, False)]


@pytest.mark.parametrize("value", [math.nan, math.inf, (1.0, (2.0, -math.inf))])
def test_a_value_that_is_not_finite_never_reaches_a_driver(value: Any) -> None:
    world = Scripted({}, ["u"])
    u = SampledOutput[Any]("Top.u", period=ms, driver=world.drivers["u"], safe=0.0)

    async def top() -> None:
        await u.write(value)

    outcome = Network(Body(top), [u]).run(world, until=100 * ms)
    assert isinstance(outcome.error, Fault)
    assert "Top.u" in str(outcome.error)
    assert world.written["u"] == [(0, 0.0)]


@pytest.mark.parametrize("way", ["end", "exception", "deadlock", "time limit", "Ctrl-C", "KeyboardInterrupt"])
def test_outputs_are_released_on_every_exit(way: str) -> None:
    world = Scripted({}, ["u", "v"])
    u = SampledOutput[float]("u", period=ms, driver=world.drivers["u"], safe=0.5)
    v = EventOutput[float]("v", driver=world.drivers["v"], safe=0.0)

    async def top() -> None:
        await v.write(9.0)
        await wait(2 * ms)
        if way == "exception":
            raise KeyError
        if way == "deadlock":
            from cspdiag.runtime import stop

            await stop()
        if way == "Ctrl-C":
            signal.raise_signal(signal.SIGINT)
        if way == "KeyboardInterrupt":
            raise KeyboardInterrupt
        if way == "time limit":
            await wait(1000 * ms)

    outcome = Network(Body(top), [u, v]).run(world, until=10 * ms)
    expected = {"end": "terminated", "exception": "failed", "Ctrl-C": "stopped", "KeyboardInterrupt": "failed"}
    assert outcome.ended == expected.get(way, way)
    assert world.written["u"][-1][1] == 0.5
    assert world.written["v"][-1][1] == 0.0


def test_a_deadlock_is_detected_although_ticks_would_continue() -> None:
    world = Scripted({"x": COUNT})
    port = SampledInput[int]("x", period=ms, driver=world.drivers["x"])

    async def top() -> None:
        from cspdiag.runtime import stop

        await port.reader().read()
        await stop()

    outcome = Network(Body(top), [port]).run(world, until=1000 * ms)
    assert (outcome.ended, outcome.time) == ("deadlock", ms)


def test_the_time_limit_includes_its_own_instant() -> None:
    log: list[int] = []

    async def top() -> None:
        while True:
            await wait(ms)
            log.append(network.now)

    network = Network(Body(top))
    outcome = network.run(until=3 * ms)
    assert (outcome.ended, outcome.time) == ("time limit", 3 * ms)
    assert log == [ms, 2 * ms, 3 * ms]


def test_the_same_run_twice_gives_the_same_trace() -> None:
    def once() -> list[tuple[int, str, Any]]:
        world = Scripted({"x": COUNT, "e": {0: 0, 3 * ms: 1, 7 * ms: 2}}, ["u"])
        x = SampledInput[int]("x", period=2 * ms, driver=world.drivers["x"])
        e = EventInput[int]("e", driver=world.drivers["e"])
        u = SampledOutput[int]("u", period=3 * ms, driver=world.drivers["u"], safe=0)

        class Loop(Process):
            def __init__(self) -> None:
                super().__init__("loop")
                self.x = x.reader(self)
                self.e = e.reader(self)
                self.choice = Alternative(Input(self.e), Input(self.x))

            async def run(self) -> None:
                for _ in range(8):
                    await self.choice.select()
                    await u.write(self.choice.value)

        trace = Trace()
        Network(Loop(), [x, e, u]).run(world, observer=trace, until=100 * ms)
        return trace.communications

    assert once() == once()
    assert len(once()) > 8


def test_a_process_reads_all_inputs_of_one_period_at_the_same_tick_from_the_first_time_on() -> None:
    world = Scripted({"stick": COUNT, "x": COUNT})
    ports = [SampledInput[int](name, period=ms, driver=world.drivers[name]) for name in ("stick", "x")]
    taken: list[tuple[int, int]] = []

    class Servo(Process):
        def __init__(self) -> None:
            super().__init__("Servo")
            self.stick = ports[0].reader(self)
            self.x = ports[1].reader(self)
            self.choice = Alternative(Ready(self.x))

        async def run(self) -> None:
            for _ in range(3):
                await self.choice.select()
                taken.append(await read_all(self.x, self.stick))

    assert Network(Servo(), ports).run(world, until=100 * ms).ended == "terminated"
    assert taken == [(1, 1), (2, 2), (3, 3)]


def test_a_sample_held_for_a_first_read_cannot_be_missed_before_it() -> None:
    world = Scripted({"x": COUNT, "rare": COUNT})
    ports = [SampledInput[int](name, period=ms, driver=world.drivers[name]) for name in ("x", "rare")]
    taken: list[int] = []

    class Reader(Process):
        def __init__(self) -> None:
            super().__init__("Reader")
            self.x = ports[0].reader(self)
            self.rare = ports[1].reader(self)

        async def run(self) -> None:
            for _ in range(5):
                await self.x.read()
            taken.append(await self.rare.read())
            await self.x.read()
            taken.append(await self.rare.read())

    outcome = Network(Reader(), ports).run(world, until=100 * ms)
    assert outcome.ended == "terminated"
    assert taken == [5, 6]
    assert outcome.missed == {"x": 0, "rare": 0}


def test_an_input_with_another_offset_is_followed_by_itself() -> None:
    world = Scripted({"x": COUNT, "y": COUNT})
    x = SampledInput[int]("x", period=ms, driver=world.drivers["x"])
    y = SampledInput[int]("y", period=ms, offset=300 * us, driver=world.drivers["y"])
    times: list[int] = []

    class Reader(Process):
        def __init__(self) -> None:
            super().__init__("Reader")
            self.x, self.y = x.reader(self), y.reader(self)

        async def run(self) -> None:
            for end in (self.x, self.x, self.y, self.x, self.y):
                await end.read()
                times.append(network.now)

    network = Network(Reader(), [x, y])
    assert network.run(world, until=100 * ms).missed == {"x": 0, "y": 0}
    assert times == [ms, 2 * ms, 2300 * us, 3 * ms, 3300 * us]


def test_an_output_with_an_offset_changes_between_the_samples() -> None:
    world = Scripted({"x": COUNT}, ["u"])
    x = SampledInput[int]("x", period=2 * ms, driver=world.drivers["x"])
    u = SampledOutput[int]("u", period=2 * ms, offset=500 * us, driver=world.drivers["u"], safe=-1)

    async def top() -> None:
        end = x.reader()
        for _ in range(2):
            await u.write(await end.read())
        await wait(ms)

    Network(Body(top), [x, u]).run(world, until=100 * ms)
    assert world.written["u"] == [(2500 * us, 2), (4500 * us, 4), (5000 * us, -1)]


def test_a_process_that_runs_again_waits_for_the_next_tick_again() -> None:
    world = Scripted({"x": COUNT, "y": COUNT})
    ports = [SampledInput[int](name, period=ms, driver=world.drivers[name]) for name in ("x", "y")]
    taken: list[int] = []

    class Reader(Process):
        def __init__(self) -> None:
            super().__init__("Reader")
            self.x = ports[0].reader(self)
            self.y = ports[1].reader(self)

        async def run(self) -> None:
            taken.append(await self.y.read())
            taken.append(await self.x.read())

    reader = Reader()

    async def top() -> None:
        await reader
        await reader

    assert Network(Body(top), ports).run(world, until=100 * ms).ended == "terminated"
    assert taken == [1, 1, 2, 2]
