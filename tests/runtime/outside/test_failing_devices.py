"""Devices that fail or fall silent, and signals: outputs are released, and there is a report."""

from __future__ import annotations

import signal
import threading
from contextlib import suppress

import pytest

from cspdiag.runtime import (
    Alternative,
    EventOutput,
    Input,
    Network,
    Outcome,
    SampledInput,
    SampledOutput,
    Timeout,
    ms,
    parallel,
    stop,
    wait,
)
from cspdiag.runtime.kernel.signals import left_to_the_main_thread
from tests.runtime.real_time.test_real_time import Device
from tests.runtime.support import Body, Scripted


class Dumb:
    """Its first ``reads`` calls succeed; the next one does not return until it is closed."""

    blocking = True

    def __init__(self, reads: int) -> None:
        self.reads = reads
        self.closed = threading.Event()

    def read(self) -> float:
        self.reads -= 1
        if self.reads < 0:
            self.closed.wait()
        return 1.0

    def close(self) -> None:
        self.closed.set()


def test_a_blocking_device_that_falls_silent_is_missed_samples_and_then_a_timeout_that_can_be_caught() -> None:
    port = SampledInput[float]("Top.x", period=20 * ms, driver=Dumb(3))
    caught: list[str] = []

    async def top() -> None:
        end = port.reader()
        try:
            while True:
                await end.read()
        except Timeout as error:
            caught.append(str(error))

    outcome = Network(Body(top), [port]).run(real_time=True)
    assert outcome.ended == "terminated"
    assert outcome.missed["Top.x"] >= 25
    assert caught[0].startswith("driver Dumb has brought no sample of Top.x for ")


def test_a_silent_device_affects_an_alternative_too() -> None:
    port = SampledInput[float]("Top.x", period=50 * ms, driver=Dumb(1))
    end = port.reader()
    choice = Alternative(Input(end))

    async def top() -> None:
        while True:
            await choice.select()

    outcome = Network(Body(top), [port]).run(real_time=True)
    assert isinstance(outcome.error, Timeout)


def test_where_misses_are_counted_a_silent_device_is_counted() -> None:
    port = SampledInput[float]("Top.x", period=20 * ms, driver=Dumb(2))

    async def top() -> None:
        end = port.reader()
        while True:
            await end.read()

    outcome = Network(Body(top), [port]).run(real_time=True, on_miss="count", until=800 * ms)
    assert outcome.ended == "time limit"
    assert outcome.missed["Top.x"] >= 30


def test_one_failed_write_does_not_take_the_safe_value_away() -> None:
    class Motor:
        blocking = True

        def __init__(self) -> None:
            self.written: list[float] = []

        def write(self, value: float) -> None:
            self.written.append(value)
            if value == 2.0:
                raise OSError("bus off")

    motor = Motor()
    u = EventOutput[float]("Top.u", driver=motor, safe=0.0)

    async def top() -> None:
        await u.write(2.0)
        await wait(60_000 * ms)

    outcome = Network(Body(top), [u]).run(real_time=True)
    assert str(outcome.error) == "driver Motor failed to write at port Top.u: OSError: bus off"
    assert motor.written == [2.0, 0.0]
    assert outcome.release_errors == []
    assert outcome.exit_code == 1


@pytest.mark.parametrize("blocking", [False, True])
def test_a_safe_value_that_fails_is_an_unsuccessful_end(blocking: bool) -> None:
    motor = Device("write", blocking)
    u = EventOutput[float]("Top.u", driver=motor, safe=0.0)

    async def top() -> None:
        await wait(5 * ms)

    outcome = Network(Body(top), [u]).run(real_time=True)
    assert outcome.ended == "terminated"
    assert [str(error) for error in outcome.release_errors] == [
        "driver Device failed to write at port Top.u: OSError: cable pulled"
    ]
    assert outcome.exit_code == 1


def test_an_output_gets_nothing_after_its_safe_value() -> None:
    motor = Device()
    u = EventOutput[float]("Top.u", driver=motor, safe=0.0)

    async def top() -> None:
        try:
            await stop()
        finally:
            await u.write(9.0)

    Network(Body(top), [u]).run()
    assert motor.written == [0.0]


def test_signals_belong_to_the_caller_again_after_the_run() -> None:
    before = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)]
    u = EventOutput[float]("Top.u", driver=Device(), safe=0.0)

    async def top() -> None:
        signal.raise_signal(signal.SIGTERM)
        await wait(60_000 * ms)

    outcome = Network(Body(top), [u]).run(real_time=True)
    assert (outcome.ended, outcome.signal, outcome.exit_code) == ("stopped", signal.SIGTERM, 143)
    assert [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)] == before


def test_a_handler_of_the_caller_is_kept_and_outputs_are_released() -> None:
    motor = Device()
    u = EventOutput[float]("Top.u", driver=motor, safe=0.0)

    class AskedError(Exception):
        pass

    def request(*_: object) -> None:
        raise AskedError

    async def top() -> None:
        await u.write(3.0)
        threading.Timer(0.05, signal.pthread_kill, (main_thread, signal.SIGTERM)).start()
        await wait(60_000 * ms)

    main_thread = threading.main_thread().ident
    assert main_thread is not None
    before = signal.signal(signal.SIGTERM, request)
    try:
        with pytest.raises(AskedError):
            Network(Body(top), [u]).run(real_time=True)
    finally:
        signal.signal(signal.SIGTERM, before)
    assert motor.written == [3.0, 0.0]


def test_a_handler_of_the_caller_that_raises_again_and_again_does_not_interrupt_the_release() -> None:
    class AskedError(Exception):
        pass

    calls: list[list[float]] = []

    class Motor:
        def __init__(self) -> None:
            self.written: list[float] = []

        def write(self, value: float) -> None:
            if value == 0.0:
                signal.raise_signal(signal.SIGTERM)
            self.written.append(value)

    motor = Motor()
    u = EventOutput[float]("Top.u", driver=motor, safe=0.0)

    def request(*_: object) -> None:
        calls.append([*motor.written])
        raise AskedError

    async def top() -> None:
        await u.write(3.0)
        with suppress(BaseException):
            signal.raise_signal(signal.SIGTERM)
        await wait(ms)

    before = signal.signal(signal.SIGTERM, request)
    try:
        with pytest.raises(AskedError):
            Network(Body(top), [u]).run(real_time=True)
        assert signal.getsignal(signal.SIGTERM) is request
    finally:
        signal.signal(signal.SIGTERM, before)
    assert calls == [[3.0], [3.0, 0.0]]


def test_an_environment_that_exits_is_a_failure_of_the_environment() -> None:
    class Bench(Scripted):
        def advance(self, now: int) -> None:
            if now >= 3 * ms:
                raise SystemExit(0)

    bench, motor = Bench({}), Device()
    u = SampledOutput[float]("Top.u", period=ms, driver=motor, safe=0.0)

    async def top() -> None:
        await wait(60 * ms)

    outcome = Network(Body(top), [u]).run(bench)
    assert str(outcome.error) == "the environment Bench failed: SystemExit: 0"
    assert (outcome.exit_code, motor.written) == (1, [0.0])


def test_branches_that_raise_exceptions_without_a_text_fail_as_others() -> None:
    motor = Device()
    u = EventOutput[float]("Top.u", driver=motor, safe=0.0)

    async def branch() -> None:
        await wait(ms)
        raise Unspeakable(5)

    async def top() -> None:
        await parallel(branch(), branch())

    outcome = Network(Body(top), [u]).run()
    assert isinstance(outcome.error, Unspeakable)
    assert motor.written == [0.0]


@pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="signals cannot be blocked")
def test_a_thread_started_next_to_the_run_receives_no_signals() -> None:
    blocked: list[int] = []
    thread = threading.Thread(target=lambda: blocked.extend(signal.pthread_sigmask(signal.SIG_BLOCK, ())))
    with left_to_the_main_thread():
        thread.start()
    thread.join()
    assert {signal.SIGINT, signal.SIGTERM, signal.SIGRTMIN + 3} <= set(blocked)
    assert not signal.pthread_sigmask(signal.SIG_BLOCK, ())


class Unspeakable(Exception):  # noqa: N818
    """An exception whose text cannot be made."""

    def __str__(self) -> str:
        return self.args[0]  # type: ignore[no-any-return]


class Bus:
    """Remembers the values written to it, and raises ``error`` at a safe value (0.0) or at ``close``."""

    def __init__(
        self, fails: str = "", error: type[BaseException] = KeyboardInterrupt, *, blocking: bool = False
    ) -> None:
        self.fails = fails
        self.error = error
        self.blocking = blocking
        self.written: list[float] = []
        self.closed = 0

    def write(self, value: float) -> None:
        self.written.append(value)
        if value == 0.0 and self.fails == "write":
            raise self.error(5)

    def close(self) -> None:
        self.closed += 1
        if self.fails == "close":
            raise self.error(5)


@pytest.mark.parametrize("blocking", [False, True])
@pytest.mark.parametrize("in_another_thread", [False, True])
@pytest.mark.parametrize("error", [KeyboardInterrupt, SystemExit, Unspeakable])
@pytest.mark.parametrize("operation", ["write", "close"])
def test_what_the_release_raises_repeats_nothing_and_keeps_no_other_output_from_its_own(
    operation: str, error: type[BaseException], in_another_thread: bool, blocking: bool
) -> None:
    first, second = Bus(operation, error, blocking=blocking), Bus()
    ports = [EventOutput("Top.a", safe=0.0, driver=first), EventOutput("Top.b", safe=0.0, driver=second)]

    async def top() -> None:
        await wait(5 * ms)

    outcomes: list[Outcome] = []

    def run() -> None:
        outcomes.append(Network(Body(top), ports).run(real_time=True))

    if in_another_thread:
        thread = threading.Thread(target=run)
        thread.start()
        thread.join()
    else:
        run()
    assert (first.written, second.written) == ([0.0], [0.0])
    assert (first.closed, second.closed) == (1, 1)
    (outcome,) = outcomes
    assert outcome.exit_code == 1
    (failed,) = outcome.release_errors
    assert f"driver Bus failed to {operation} at port Top.a: {error.__name__}" in str(failed)


def test_a_safe_value_interrupted_by_ctrl_c_is_written_again() -> None:
    class Motor(Bus):
        def write(self, value: float) -> None:
            if not self.written:
                self.written.append(9.0)
                signal.signal(signal.SIGINT, signal.default_int_handler)
                signal.raise_signal(signal.SIGINT)
            super().write(value)

    motor = Motor()
    ports = [EventOutput("Top.a", safe=0.0, driver=motor)]

    async def top() -> None:
        await wait(ms)

    assert Network(Body(top), ports).run().release_errors == []
    assert motor.written == [9.0, 0.0]
