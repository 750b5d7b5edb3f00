"""Random programs: the runtime compared with the specification, and what must hold for all of them."""

from __future__ import annotations

import contextlib
from collections.abc import Awaitable
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from cspdiag.runtime import (
    Alternative,
    AnyChannel,
    Broadcast,
    Buffer,
    Channel,
    Input,
    Output,
    Overwriting,
    ProcessError,
    interrupt,
    parallel,
    prioritized_parallel,
    read_all,
    wait,
    write_all,
)
from cspdiag.runtime.choice.guards import After, Guard
from tests.runtime.specification import Interpreter, Operation
from tests.runtime.support import Trace, run

PROCESSES = 4


@st.composite
def programs(draw: st.DrawFn) -> list[list[Operation]]:
    """Operations for every process; each channel has one writing and one reading process."""
    ends = draw(
        st.lists(st.permutations(range(PROCESSES)).map(lambda order: (order[0], order[1])), min_size=2, max_size=7)
    )
    values = iter(range(10_000))
    result: list[list[Operation]] = []
    for process in range(PROCESSES):
        outputs = [channel for channel, (writer, _) in enumerate(ends) if writer == process]
        inputs = [channel for channel, (_, reader) in enumerate(ends) if reader == process]
        operations: list[Operation] = []
        for _ in range(draw(st.integers(0, 7))):
            kinds = ["wait"] + ["read"] * 2 * bool(inputs) + ["write"] * 2 * bool(outputs)
            kinds += ["select"] * 3 * bool(inputs or outputs)
            match draw(st.sampled_from(kinds)):
                case "wait":
                    operations.append(("wait", draw(st.integers(1, 3))))
                case "read":
                    operations.append(("read", draw(st.sampled_from(inputs))))
                case "write":
                    operations.append(("write", draw(st.sampled_from(outputs)), next(values)))
                case _:
                    offered: list[Operation] = [("in", channel) for channel in inputs]
                    offered += [("out", channel, next(values)) for channel in outputs]
                    guards = draw(st.lists(st.sampled_from(offered), min_size=1, max_size=4, unique_by=lambda g: g[:2]))
                    operations.append(("select", tuple(guards), draw(st.booleans())))
        result.append(operations * draw(st.integers(1, 2)))
    return result


def executed(programs: list[list[Operation]]) -> tuple[list[tuple[int, str, Any]], bool]:
    channels = [Channel[int](f"c{index}") for index in range(10)]

    def guard(description: Operation) -> Guard:
        if description[0] == "in":
            return Input(channels[description[1]])
        return Output(channels[description[1]], description[2])

    async def process(operations: list[Operation]) -> None:
        for operation in operations:
            match operation[0]:
                case "wait":
                    await wait(operation[1])
                case "read":
                    await channels[operation[1]].read()
                case "write":
                    await channels[operation[1]].write(operation[2])
                case _:
                    await Alternative(*map(guard, operation[1]), prioritized=operation[2]).select()

    async def top() -> None:
        await parallel(*map(process, programs))

    trace = Trace()
    outcome = run(top, observer=trace)
    assert outcome.error is None, outcome.error
    return trace.communications, outcome.ended == "terminated"


@given(programs())
@settings(max_examples=300, deadline=None)
def test_the_runtime_does_what_the_specification_says(programs: list[list[Operation]]) -> None:
    assert executed(programs) == Interpreter(programs).run()


@given(
    st.sampled_from([Channel, AnyChannel, Buffer, Overwriting, Broadcast]),
    st.lists(st.integers(0, 3), max_size=12),
    st.lists(st.integers(0, 3), min_size=12, max_size=12),
    st.booleans(),
)
@settings(max_examples=150, deadline=None)
def test_no_channel_loses_doubles_or_reorders_values(
    kind: Any, pauses: list[int], reader_pauses: list[int], alternates: bool
) -> None:
    channel = kind("c", 3) if kind in (Buffer, Overwriting) else kind("c")
    end = channel.reader()
    taken: list[int] = []

    async def writer() -> None:
        for value, pause in enumerate(pauses):
            await wait(pause)
            await channel.write(value)

    async def reader() -> None:
        choice = Alternative(Input(end), After(10))
        for pause in reader_pauses:
            await wait(pause)
            if await choice.select() == 0:
                taken.append(choice.value)

    async def plain_reader() -> None:
        for pause in reader_pauses[: len(pauses)]:
            await wait(pause)
            taken.append(await end.read())

    async def top() -> None:
        await parallel(writer(), reader() if alternates else plain_reader())

    run(top, until=1000)
    if kind is Overwriting:
        assert taken == sorted(set(taken))
    else:
        assert taken == list(range(len(taken)))
        assert alternates or len(taken) == len(pauses)


class FailureError(ProcessError):
    pass


@st.composite
def bodies(draw: st.DrawFn, depth: int = 3) -> Any:
    """A description of nested parallels, interrupts and handlers around communications that may never happen."""
    kinds = ["communicate", "together", "select", "wait", "fail"]
    if depth:
        kinds += ["parallel", "prioritized", "interrupt", "catch", "sequence"] * 2
    kind = draw(st.sampled_from(kinds))
    match kind:
        case "communicate" | "together" | "select":
            return kind, draw(st.integers(0, 3)), draw(st.booleans())
        case "wait" | "fail":
            return kind, draw(st.integers(0, 5))
        case "interrupt":
            return kind, draw(bodies(depth - 1)), draw(st.integers(0, 4))
        case "catch":
            return kind, draw(bodies(depth - 1)), draw(bodies(depth - 1))
        case _:
            return kind, draw(st.lists(bodies(depth - 1), min_size=1, max_size=4))


@given(bodies())
@settings(max_examples=300, deadline=None)
def test_cancellation_leaves_no_trace_in_the_channels(description: Any) -> None:
    channels = [AnyChannel[int](f"c{index}") for index in range(4)]

    def body(part: Any) -> Awaitable[object]:
        return execute(part)

    async def nothing() -> None:
        pass

    async def execute(part: Any) -> None:
        match part:
            case ("communicate", index, True):
                await channels[index].write(1)
            case ("communicate", index, False):
                await channels[index].read()
            case ("together", index, True):
                await write_all((channels[index], 1), (channels[index - 1], 2))
            case ("together", index, False):
                await read_all(channels[index], channels[index - 1])
            case ("select", index, True):
                await Alternative(Output(channels[index], 1), Input(channels[index - 1])).select()
            case ("select", index, False):
                await Alternative(Input(channels[index]), After(3)).select()
            case ("wait", duration):
                await wait(duration)
            case ("fail", duration):
                await wait(duration)
                raise FailureError
            case ("parallel", parts):
                await parallel(*map(body, parts))
            case ("prioritized", parts):
                await prioritized_parallel(*map(body, parts))
            case ("sequence", parts):
                for inner in parts:
                    await execute(inner)
            case ("interrupt", inner, index):
                await interrupt(body(inner), Input(channels[index]) if index < 4 else After(2), nothing)
            case ("catch", inner, handler):
                try:
                    await execute(inner)
                except FailureError:
                    await execute(handler)

    async def fails_late() -> None:
        await wait(50)
        raise FailureError

    async def top() -> None:
        with contextlib.suppress(FailureError):
            await parallel(execute(description), fails_late())
        for channel in channels:
            assert not channel._readers
            assert not channel._writers
            assert not channel._meeting.reading
            assert not channel._meeting.writing
        await parallel(*(channel.read() for channel in channels), *(channel.write(7) for channel in channels))

    traces = []
    for _ in range(2):
        trace = Trace()
        outcome = run(top, observer=trace)
        assert outcome.ended == "terminated", outcome.error
        assert [entry[1:] for entry in trace.communications[-4:]] == [(f"c{index}", 7) for index in range(4)]
        traces.append(trace.communications)
    assert traces[0] == traces[1]
