"""Against the clock: what happens, never how fast."""

from __future__ import annotations

import queue
import signal
import threading
import time
from contextlib import suppress
from itertools import pairwise
from typing import Any

import pytest

from cspdiag.runtime import (
    Alternative,
    DevicePort,
    DriverError,
    EventInput,
    EventOutput,
    Input,
    Network,
    SampledInput,
    SampledOutput,
    Signal,
    Steps,
    Task,
    Timeout,
    ms,
    parallel,
    stop,
    wait,
)
from tests.runtime.compiled.programs import Program
from tests.runtime.support import Body, Scripted


class Device:
    """Counts the operations on it; an operation named in ``fails`` fails."""

    def __init__(self, fails: str = "", blocking: bool = False) -> None:
        self.fails = fails
        self.blocking = blocking
        self.calls: list[str] = []
        self.written: list[Any] = []
        self.threads: set[str] = set()

    def _call(self, name: str) -> None:
        self.calls.append(name)
        self.threads.add(threading.current_thread().name)
        if self.fails == name:
            raise OSError("cable pulled")

    def open(self) -> None:
        self._call("open")

    def close(self) -> None:
        self._call("close")

    def read(self) -> float:
        self._call("read")
        return 1.0

    def write(self, value: Any) -> None:
        self._call("write")
        self.written.append(value)


def test_a_run_takes_the_time_it_simulates_and_ticks_do_not_drift() -> None:
    port = SampledInput[float]("x", period=5 * ms, driver=Signal(0.5))
    end = port.reader()

    async def top() -> None:
        for _ in range(10):
            await end.read()

    began = time.monotonic()
    # A busy machine may let this program miss samples; the clock is what is tested.
    outcome = Network(Body(top), [port]).run(real_time=True, on_miss="count")
    assert outcome.ended == "terminated"
    assert outcome.time == (10 + outcome.missed["x"]) * 5 * ms
    assert time.monotonic() - began >= outcome.time / 1e9
    assert outcome.jitter[5 * ms].count == 10 + outcome.missed["x"]
    assert outcome.jitter[5 * ms].worst >= outcome.jitter[5 * ms].mean >= 0


def test_a_process_that_computes_too_long_misses_samples() -> None:
    port = SampledInput[float]("x", period=2 * ms, driver=Signal(0.5))
    end = port.reader()

    async def top() -> None:
        await end.read()
        time.sleep(0.02)
        await wait(ms)
        await end.read()

    outcome = Network(Body(top), [port]).run(real_time=True)
    assert isinstance(outcome.error, Timeout)
    assert outcome.missed["x"] >= 1


def test_a_driver_slower_than_its_period_keeps_no_process_from_running() -> None:
    class Slow:
        calls = 0

        def read(self) -> float:
            self.calls += 1
            time.sleep(0.003)
            return 1.0

    slow, device, taken = Slow(), Device(), 0
    port = SampledInput[float]("x", period=2 * ms, driver=slow)
    out = SampledOutput[float]("y", period=2 * ms, driver=device, safe=-1.0)
    end = port.reader()

    async def top() -> None:
        nonlocal taken
        while True:
            await end.read()
            taken += 1

    outcome = Network(Body(top), [port, out]).run(real_time=True, until=60_000 * ms)
    assert isinstance(outcome.error, Timeout)
    assert outcome.missed["x"] >= 1
    assert device.written == [-1.0]
    counted = Network(Body(top), [port, out]).run(real_time=True, until=300 * ms, on_miss="count")
    assert counted.ended == "time limit"
    assert taken >= 1
    assert counted.missed["x"] >= 1
    assert slow.calls < counted.time // (2 * ms) + outcome.time // (2 * ms)


def test_events_of_a_blocking_driver_come_from_a_thread_of_their_own() -> None:
    class Button:
        blocking = True

        def __init__(self) -> None:
            self.presses: queue.Queue[int] = queue.Queue()
            self.threads: set[int] = set()

        def read(self) -> int:
            self.threads.add(threading.get_ident())
            return self.presses.get()

    button, lamp = Button(), Device(blocking=True)
    presses = EventInput[int]("press", driver=button)
    light = EventOutput[int]("light", driver=lamp, safe=0)
    end = presses.reader()
    choice = Alternative(Input(end))

    async def top() -> None:
        while True:
            await choice.select()
            await light.write(choice.value)
            if choice.value == 3:
                return

    def press() -> None:
        for value in (1, 2, 3):
            time.sleep(0.01)
            button.presses.put(value)

    threading.Thread(target=press).start()
    outcome = Network(Body(top), [presses, light]).run(real_time=True)
    button.presses.put(0)  # Its thread ends together with the call that it is executing.
    assert outcome.ended == "terminated"
    assert lamp.written[-1] == 0
    # On a busy machine several presses become one event, and a slow device may skip values, but never the safe one.
    assert lamp.written[:-1] == [value for value in (1, 2, 3) if value in lamp.written]
    assert threading.get_ident() not in button.threads


def test_a_blocking_sampled_driver_is_read_ahead_outside_the_scheduler() -> None:
    device = Device(blocking=True)
    port = SampledInput[float]("x", period=5 * ms, driver=device)
    end = port.reader()

    async def top() -> None:
        for _ in range(3):
            assert await end.read() == 1.0

    # A busy machine may let this program miss samples; the test is about which thread reads.
    assert Network(Body(top), [port]).run(real_time=True, on_miss="count").ended == "terminated"
    assert device.threads == {"MainThread", "driver of x"}
    assert device.calls[-1] == "close"


@pytest.mark.parametrize("blocking", [False, True])
@pytest.mark.parametrize("real_time", [False, True])
@pytest.mark.parametrize("fails", ["open", "read", "write"])
def test_a_failing_driver_ends_the_run_with_the_outputs_released(fails: str, real_time: bool, blocking: bool) -> None:
    sensor, motor, brake = Device(fails, blocking), Device(fails, blocking), Device()
    x = SampledInput[float]("Top.x", period=ms, driver=sensor)
    u = SampledOutput[float]("Top.u", period=ms, driver=motor, safe=0.0)
    b = SampledOutput[float]("Top.b", period=ms, driver=brake, safe=1.0)
    end = x.reader()

    async def top() -> None:
        while True:
            with suppress(Exception):  # no process can catch a failing driver
                await u.write(await end.read())

    outcome = Network(Body(top), [b, x, u]).run(real_time=real_time, until=2000 * ms)
    assert outcome.ended == "failed"
    assert isinstance(outcome.error, DriverError)
    assert outcome.error.operation == fails
    assert "Device" in str(outcome.error)
    assert outcome.error.port in {"Top.x", "Top.u"}
    assert "cable pulled" in str(outcome.error)
    assert brake.written == [1.0]
    assert brake.calls[-1] == "close"
    for device in (sensor, motor):
        assert device.calls.count("close") == (fails != "open")


def test_a_device_with_several_ports_is_opened_and_closed_once() -> None:
    class Board:
        def __init__(self) -> None:
            self.calls: list[str] = []

        def open(self) -> None:
            self.calls.append("open")

        def close(self) -> None:
            self.calls.append("close")

        def read(self, port: str) -> float:
            return 2.0

        def write(self, port: str, value: float) -> None:
            self.calls.append(f"{port} = {value}")

    board = Board()
    x = SampledInput[float]("Top.x", period=ms, driver=DevicePort(board, "adc"))
    u = SampledOutput[float]("Top.u", period=ms, driver=DevicePort(board, "dac"), safe=0.0)
    end = x.reader()

    async def top() -> None:
        await u.write(await end.read())
        await wait(2 * ms)

    Network(Body(top), [x, u]).run()
    assert board.calls == ["open", "dac = 2.0", "dac = 0.0", "close"]


def test_the_end_of_a_run_wakes_no_process_and_closes_everything_although_a_driver_fails_to_close() -> None:
    bad, good = Device("close"), Device()
    a = EventOutput[float]("a", driver=bad, safe=0.0)
    b = EventOutput[float]("b", driver=good, safe=0.0)

    async def top() -> None:
        await parallel(a.write(1.0), stop_soon())

    async def stop_soon() -> None:
        await wait(ms)
        raise KeyError

    outcome = Network(Body(top), [a, b]).run()
    assert isinstance(outcome.error, KeyError)
    assert [str(error) for error in outcome.release_errors] == [
        "driver Device failed to close at port a: OSError: cable pulled"
    ]
    assert good.calls[-1] == "close"


def test_ctrl_c_while_all_processes_wait_stops_the_run_and_releases_the_outputs() -> None:
    motor = Device()
    u = EventOutput[float]("u", driver=motor, safe=0.0)

    async def top() -> None:
        await u.write(3.0)
        threading.Timer(0.05, signal.pthread_kill, (main_thread, signal.SIGINT)).start()
        await wait(60_000 * ms)

    main_thread = threading.main_thread().ident
    assert main_thread is not None
    outcome = Network(Body(top), [u]).run(real_time=True)
    assert outcome.ended == "stopped"
    assert motor.written == [3.0, 0.0]


def test_virtual_and_real_time_give_the_same_values() -> None:
    def once(real_time: bool) -> list[tuple[int, Any]]:
        world = Scripted({"x": {k * ms: k for k in range(100)}}, ["u"])
        x = SampledInput[int]("x", period=4 * ms, driver=world.drivers["x"])
        u = SampledOutput[int]("u", period=4 * ms, driver=world.drivers["u"], safe=-1)
        end = x.reader()

        async def top() -> None:
            for _ in range(5):
                await u.write(await end.read())

        Network(Body(top), [x, u]).run(world, real_time=real_time, on_miss="count")
        return world.written["u"]

    assert once(False)[0] == (8 * ms, 4)
    assert len(once(True)) >= 2


def test_a_time_limit_ends_a_real_time_run_in_which_nothing_happens() -> None:
    never = EventInput[int]("never", driver=Signal(0))

    async def top() -> None:
        await parallel(never.reader().read(), stop())

    outcome = Network(Body(top), [never]).run(real_time=True, until=20 * ms)
    assert (outcome.ended, outcome.time) == ("time limit", 20 * ms)


@pytest.mark.parametrize("optimized", [False, True])
def test_the_clock_is_read_after_each_step(optimized: bool) -> None:
    order: list[str] = []

    class Reading:
        def read(self) -> float:
            order.append("read")
            return 0.0

    port = SampledInput[float]("x", period=2 * ms, driver=Reading())

    def compute() -> None:
        order.append("compute")
        time.sleep(0.005)

    def optimized_steps(me: Task) -> Steps:
        compute()
        yield from ()

    def optimized_top(me: Task) -> Steps:
        me.scheduler.current = me
        yield from parallel(*[optimized_steps] * 3)

    async def body() -> None:
        compute()

    async def top() -> None:
        await parallel(*(Body(body, name) for name in "abc"))

    program = Program(optimized_top) if optimized else Body(top)
    outcome = Network(program, [port]).run(real_time=True, on_miss="count")
    assert outcome.ended == "terminated"
    computed = [position for position, what in enumerate(order) if what == "compute"]
    assert len(computed) == 3
    for first, second in pairwise(computed):
        assert "read" in order[first:second], order
