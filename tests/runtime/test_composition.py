"""Parallel, priorities, exceptions, cancellation, interrupt."""

from __future__ import annotations

import contextlib
from collections.abc import Awaitable, Callable
from functools import partial

import pytest

from cspdiag.runtime import (
    After,
    Alternative,
    Buffer,
    Cancelled,
    Channel,
    Fault,
    Input,
    Network,
    Output,
    Process,
    ProcessError,
    Ready,
    Skip,
    Timeout,
    Variable,
    group,
    interrupt,
    ms,
    parallel,
    prioritized_parallel,
    read_all,
    stop,
    wait,
    write_all,
)
from tests.runtime.support import Body, Trace, finish, run, traced


class OverheatedError(ProcessError):
    pass


async def fails() -> None:
    raise OverheatedError


def test_branches_start_in_text_order_and_the_parent_continues_after_the_last() -> None:
    log: list[str] = []

    async def branch(name: str, delay: int) -> None:
        log.append(name)
        await wait(delay * ms)
        log.append(f"{name} ends")

    async def top() -> None:
        await parallel(branch("a", 3), branch("b", 1), branch("c", 2))
        log.append("parent")

    assert finish(top).time == 3 * ms
    assert log == ["a", "b", "c", "b ends", "c ends", "a ends", "parent"]


def test_an_empty_parallel_ends_at_once() -> None:
    async def top() -> None:
        await parallel()

    finish(top)


def test_ready_processes_run_in_order_of_priority() -> None:
    log: list[str] = []

    async def busy(name: str) -> None:
        for _ in range(2):
            log.append(name)
            await wait(ms)

    async def top() -> None:
        await parallel(
            prioritized_parallel(busy("0"), prioritized_parallel(busy("1.0"), busy("1.1")), busy("2")),
            prioritized_parallel(prioritized_parallel(busy("0.0"), busy("0.1")), busy("1")),
        )

    finish(top)
    order = ["0", "0.0", "0.1", "1", "1.0", "1.1", "2"]
    assert sorted(log[:7], key=order.index) == log[:7]
    assert sorted(log[7:], key=order.index) == log[7:]


def test_a_process_of_higher_priority_runs_as_soon_as_the_lower_one_must_wait() -> None:
    channel = Channel[int]("c")
    log: list[str] = []

    async def high() -> None:
        log.append(f"high {await channel.read()}")

    async def low() -> None:
        await channel.write(1)
        log.append("low runs until it must wait")
        await wait(ms)
        log.append("low")

    async def top() -> None:
        await prioritized_parallel(high(), low())

    finish(top)
    assert log == ["low runs until it must wait", "high 1", "low"]


def test_an_exception_cancels_the_siblings_and_propagates() -> None:
    never = Channel[int]("never")
    log: list[str] = []

    async def sibling() -> None:
        try:
            await never.read()
        except Cancelled:
            log.append("cancelled")
            raise

    async def top() -> None:
        try:
            await parallel(sibling(), fails(), sibling())
        except OverheatedError:
            log.append("caught")

    finish(top)
    assert log == ["cancelled", "cancelled", "caught"]


def test_a_ready_sibling_continues_until_its_next_communication() -> None:
    here, there = Channel[int]("here"), Channel[int]("there")
    variable = Variable[int]("v", 0)

    async def sibling() -> None:
        await here.read()
        variable.value = 1
        await there.write(1)
        variable.value = 2

    async def failing() -> None:
        await here.write(1)
        raise OverheatedError

    async def top() -> None:
        with contextlib.suppress(OverheatedError):
            await parallel(sibling(), failing(), there.read())

    assert traced(top) == [(0, "here", 1)]
    assert variable.value == 1


@pytest.mark.parametrize(
    "communication",
    [
        lambda c: c.read(),
        lambda c: c.write(1),
        lambda c: read_all(c),
        lambda c: write_all((c, 1)),
        lambda c: Alternative(Input(c)).select(),
        lambda c: Alternative(Output(c, 1), After(5 * ms)).select(),
        lambda c: parallel(c.read(), stop()),
        lambda c: interrupt(c.read(), Ready(Channel("never")), stop),
        lambda c: wait(ms),
        lambda c: stop(),
    ],
)
def test_a_cancelled_process_leaves_nothing_behind(communication: Callable[[Channel[int]], Awaitable[object]]) -> None:
    channel = Channel[int]("c")

    async def sibling() -> None:
        await communication(channel)

    async def later() -> None:
        await wait(0)
        raise OverheatedError

    async def top() -> None:
        for _ in range(2):
            with contextlib.suppress(OverheatedError):
                await parallel(sibling(), later())
        await parallel(channel.read(), channel.write(3))
        await parallel(channel.write(4), channel.read())

    assert traced(top) == [(0, "c", 3), (0, "c", 4)]


def test_the_first_of_several_failing_branches_wins_and_the_others_are_noted() -> None:
    async def stubborn() -> None:
        try:
            await stop()
        finally:
            raise ValueError("could not tidy up")

    async def top() -> None:
        await parallel(stubborn(), fails())

    error = run(top).error
    assert isinstance(error, OverheatedError)
    assert error.__notes__ == ["another parallel branch ended with ValueError: could not tidy up"]


def test_exceptions_pass_through_nested_parallels() -> None:
    log: list[str] = []

    async def inner() -> None:
        try:
            await parallel(stop(), stop())
        except Cancelled:
            log.append("inner")
            raise

    async def later() -> None:
        await wait(ms)
        raise OverheatedError

    async def top() -> None:
        try:
            await parallel(inner(), parallel(stop(), later()))
        except OverheatedError:
            log.append("caught")

    assert finish(top).time == ms
    assert log == ["inner", "caught"]


def test_a_parallel_inside_a_handler_works_after_a_cancellation() -> None:
    channel = Channel[int]("c")

    async def top() -> None:
        try:
            await parallel(channel.read(), fails())
        except OverheatedError:
            await parallel(channel.read(), channel.write(8))

    assert traced(top) == [(0, "c", 8)]


def test_a_cancelled_process_cannot_communicate_in_a_finally() -> None:
    channel = Channel[int]("c")

    async def tidy() -> None:
        try:
            await stop()
        finally:
            await channel.write(0)

    async def reader() -> None:
        await channel.read()

    async def top() -> None:
        with contextlib.suppress(OverheatedError):
            await parallel(tidy(), parallel(reader(), stop()), fails())

    assert traced(top) == []


def test_a_half_done_read_all_is_abandoned() -> None:
    first, second = Channel[int]("first"), Channel[int]("second")

    async def failing() -> None:
        await first.write(1)
        await wait(ms)
        raise OverheatedError

    async def top() -> None:
        with contextlib.suppress(OverheatedError):
            await parallel(read_all(first, second), failing())
        await parallel(second.write(2), second.read())

    assert traced(top) == [(0, "first", 1), (ms, "second", 2)]


def test_interrupt_abandons_the_body_when_the_guard_is_ready() -> None:
    alarm, data = Channel[int]("alarm"), Channel[int]("data")
    guard = Input(alarm)
    log: list[object] = []

    async def body() -> None:
        while True:
            log.append(await data.read())

    async def handler() -> None:
        log.append(("alarm", guard.value))

    async def world() -> None:
        await data.write(1)
        await data.write(2)
        await alarm.write(99)
        await wait(ms)

    async def top() -> None:
        await parallel(interrupt(body(), guard, handler), world())

    finish(top)
    assert log == [1, 2, ("alarm", 99)]


def test_interrupt_lets_a_body_end_by_itself() -> None:
    log: list[str] = []

    async def body() -> None:
        await wait(ms)
        log.append("body")

    async def handler() -> None:
        log.append("handler")

    async def top() -> None:
        await interrupt(body(), After(2 * ms), handler)
        await interrupt(wait(3 * ms), After(2 * ms), handler)
        await interrupt(body(), Skip(), handler)

    assert finish(top).time == 3 * ms
    assert log == ["body", "handler", "handler"]


def test_an_exception_in_the_body_of_an_interrupt_propagates() -> None:
    async def top() -> None:
        await interrupt(fails(), Ready(Channel("never")), stop)

    assert isinstance(run(top).error, OverheatedError)


def test_interrupt_meets_an_alternative() -> None:
    alarm = Channel[int]("alarm")
    guard = Input(alarm)
    log: list[object] = []

    async def handler() -> None:
        log.append(guard.value)

    async def world() -> None:
        await wait(ms)
        log.append(await Alternative(Output(Channel[int]("other"), 1), Output(alarm, 5)).select())

    async def top() -> None:
        await parallel(interrupt(stop(), guard, handler), world())

    assert traced(top) == [(ms, "alarm", 5)]
    assert sorted(map(str, log)) == ["1", "5"]


def test_an_interrupted_body_may_hold_parallels_alternatives_and_interrupts() -> None:
    channel = Channel[int]("c")

    async def body() -> None:
        await parallel(
            Alternative(Input(channel), Input(Channel("d"))).select(),
            interrupt(parallel(stop(), stop()), Input(Channel("e")), stop),
            prioritized_parallel(stop(), wait(50 * ms)),
        )

    async def nothing() -> None:
        pass

    async def top() -> None:
        await interrupt(body(), After(2 * ms), nothing)
        await parallel(channel.read(), channel.write(1))

    assert traced(top) == [(2 * ms, "c", 1)]


def test_the_interrupting_writer_may_be_inside_the_body() -> None:
    alarm = Buffer[int]("alarm", 1)
    data = Channel[int]("data")

    async def body() -> None:
        await alarm.write(1)
        await parallel(data.read(), data.write(2))

    async def nothing() -> None:
        pass

    async def top() -> None:
        await interrupt(body(), Input(alarm), nothing)

    assert traced(top) == [(0, "alarm", 1)]


def test_processes_report_when_they_run_and_are_never_run_twice_at_once() -> None:
    trace = Trace()

    async def sleeper() -> None:
        await wait(ms)

    part = Body(sleeper, "Top.part")

    async def top() -> None:
        await group("twice", parallel(part))
        await part
        with pytest.raises(Fault, match=r"Top.part is already running"):
            await parallel(part, part)

    finish(top, observer=trace)
    assert trace.activities == [
        ("started", 0, "Top"),
        ("group", 0, "Top.twice"),
        ("started", 0, "Top.part"),
        ("ended", ms, "Top.part"),
        ("group ended", ms, "Top.twice"),
        ("started", ms, "Top.part"),
        ("ended", 2 * ms, "Top.part"),
        ("started", 2 * ms, "Top.part"),
        ("ended", 2 * ms, "Top.part"),
        ("ended", 2 * ms, "Top"),
    ]


def test_the_trace_names_the_partners() -> None:
    channel = Channel[int]("Top.c")
    trace = Trace()

    class Writer(Process):
        async def run(self) -> None:
            await channel.write(1)

    class Reader(Process):
        async def run(self) -> None:
            await Alternative(Input(channel)).select()

    async def top() -> None:
        await parallel(Writer("Top.writer"), Reader("Top.reader"))

    finish(top, observer=trace)
    assert trace.partners == [("Top.writer", "Top.reader")]


def test_a_fault_names_the_process_and_its_source() -> None:
    class Divides(Process):
        async def run(self) -> None:
            print(1 // 0)

    async def top() -> None:
        await Divides("Top.divides", source="laws.csp:12")

    error = run(top).error
    assert isinstance(error, Fault)
    assert error.place == "Top.divides (laws.csp:12)"


def test_a_declared_exception_is_caught_by_its_name_only() -> None:
    async def top() -> None:
        with contextlib.suppress(Timeout):
            await fails()

    assert isinstance(run(top).error, OverheatedError)


def test_a_deeply_nested_program_runs() -> None:
    async def nested(depth: int) -> None:
        if depth:
            await parallel(nested(depth - 1))

    async def top() -> None:
        await nested(5000)

    finish(top)


def test_methods_become_coroutines_where_they_begin() -> None:
    """A coroutine that is never begun would be reported as never awaited, which the tests treat as an error."""
    log: list[str] = []

    class Top(Process):
        async def one(self) -> None:
            log.append("one")
            await wait(ms)

        async def two(self, number: int) -> None:
            log.append(f"two {number}")
            await wait(2 * ms)

        async def resume(self) -> None:
            log.append("resume")

        async def run(self) -> None:
            await parallel(self.one, partial(self.two, 1), group("third", self.one))
            await interrupt(self.one, After(3 * ms), self.resume)
            await interrupt(group("fourth", partial(self.two, 2)), After(ms), self.resume)
            with contextlib.suppress(OverheatedError):
                await parallel(fails(), interrupt(group("never", self.one), After(ms), self.resume))
            await parallel(self.one, interrupt(parallel(self.one, stop()), After(9 * ms), self.resume))

    assert Network(Top("Top")).run(until=5 * ms).ended == "time limit"
    assert log == ["one", "two 1", "one", "one", "two 2", "resume", "one", "one"]
