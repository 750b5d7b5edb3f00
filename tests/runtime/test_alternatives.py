"""Guards and alternatives."""

from __future__ import annotations

import gc
from typing import Any

import pytest

from cspdiag.runtime import (
    After,
    Alternative,
    AnyChannel,
    Broadcast,
    Buffer,
    Channel,
    Constant,
    Input,
    Output,
    Ready,
    Skip,
    Variable,
    ms,
    parallel,
    wait,
)
from tests.runtime.support import finish, run, traced


def test_the_prioritized_alternative_takes_the_first_ready_guard_in_text_order() -> None:
    channels = [Channel[int](str(index)) for index in range(3)]
    choice = Alternative(*(Input(channel) for channel in channels), prioritized=True)
    chosen: list[tuple[int, int]] = []

    async def writer(index: int) -> None:
        for value in range(2):
            await channels[index].write(value)

    async def reader() -> None:
        await wait(ms)
        for _ in range(6):
            index = await choice.select()
            chosen.append((index, choice.value))
            await wait(ms)

    async def top() -> None:
        await parallel(reader(), *(writer(index) for index in range(3)))

    finish(top)
    assert chosen == [(0, 0), (0, 1), (1, 0), (1, 1), (2, 0), (2, 1)]


def test_the_fair_alternative_cycles_through_its_guards() -> None:
    channels = [Channel[int](str(index)) for index in range(3)]
    choice = Alternative(*(Input(channel) for channel in channels))
    chosen: list[int] = []

    async def writer(index: int) -> None:
        while True:
            await channels[index].write(index)

    async def reader() -> None:
        await wait(ms)
        for _ in range(7):
            chosen.append(await choice.select())
            await wait(ms)
        raise KeyError("enough")

    async def top() -> None:
        await parallel(reader(), *(writer(index) for index in range(3)))

    assert isinstance(run(top).error, KeyError)
    assert chosen == [0, 1, 2, 0, 1, 2, 0]


def test_it_chooses_when_it_runs_among_what_is_ready_then() -> None:
    first, second = Channel[int]("first"), Channel[int]("second")
    choice = Alternative(Input(first), Input(second), prioritized=True)
    chosen: list[int] = []

    async def reader() -> None:
        chosen.append(await choice.select())
        chosen.append(await choice.select())

    async def top() -> None:
        await parallel(reader(), second.write(2), first.write(1))

    finish(top)
    assert chosen == [0, 1], "the second channel woke it, but the first was ready when it ran"


def test_an_alternative_waits_again_if_another_process_was_faster() -> None:
    shared = AnyChannel[int]("shared")
    taken: list[str] = []

    async def alternates() -> None:
        choice = Alternative(Input(shared))
        await choice.select()
        taken.append(f"alternative {choice.value}")

    async def thief() -> None:
        await wait(ms)
        taken.append(f"thief {await shared.read()}")

    async def writer() -> None:
        await wait(ms)
        await shared.write(1)
        await wait(ms)
        await shared.write(2)

    async def top() -> None:
        await parallel(alternates(), writer(), thief())

    finish(top)
    assert sorted(taken) == ["alternative 2", "thief 1"] or sorted(taken) == ["alternative 1", "thief 2"]


def test_disabled_guards_are_not_chosen() -> None:
    first, second = Channel[int]("first"), Channel[int]("second")
    choice = Alternative(Input(first), Input(second), prioritized=True)
    chosen: list[int] = []

    async def reader() -> None:
        chosen.append(await choice.select((False, True)))
        chosen.append(await choice.select((True, False)))

    async def top() -> None:
        await parallel(first.write(1), second.write(2), reader())

    finish(top)
    assert chosen == [1, 0]


def test_no_enabled_guard_waits_forever() -> None:
    async def top() -> None:
        await Alternative(Skip()).select((False,))

    assert run(top).ended == "deadlock"


def test_skip_is_always_ready() -> None:
    async def top() -> None:
        assert await Alternative(Input(Channel("c")), Skip()).select() == 1

    finish(top)


def test_a_time_out_counts_from_the_beginning_of_the_alternative() -> None:
    channel = Channel[int]("c")
    choice = Alternative(Input(channel), After(5 * ms))

    async def reader() -> None:
        assert await choice.select() == 0
        assert await choice.select() == 1
        assert await choice.select(delays={1: 2 * ms}) == 1
        assert await choice.select(delays={1: 0}) == 1

    async def writer() -> None:
        await wait(4 * ms)
        await channel.write(1)

    async def top() -> None:
        await parallel(reader(), writer())

    assert finish(top).time == 4 * ms + 5 * ms + 2 * ms


def test_time_outs_that_were_not_needed_do_not_prolong_the_program() -> None:
    channel = Channel[int]("c")
    choice = Alternative(Input(channel), After(1000 * ms))

    async def top() -> None:
        async def reader() -> None:
            await choice.select()
            await channel.read()

        await parallel(reader(), channel.write(1))

    outcome = run(top)
    assert (outcome.ended, outcome.time) == ("deadlock", 0)


def test_an_output_guard_writes_its_value_when_the_reader_waits() -> None:
    out = Channel[int]("out")
    choice = Alternative(Output(out), After(3 * ms))
    log: list[Any] = []

    async def writer() -> None:
        log.append(await choice.select(values={0: 41}))
        log.append(await choice.select(values={0: 42}))

    async def reader() -> None:
        await wait(5 * ms)
        log.append(await out.read())

    async def top() -> None:
        await parallel(writer(), reader())

    finish(top)
    assert log[0] == 1
    assert sorted(log[1:]) == [0, 42]


@pytest.mark.parametrize("writer_first", [True, False])
@pytest.mark.parametrize("kind", [Channel, AnyChannel])
@pytest.mark.parametrize("promise", [True, False])
def test_two_alternatives_meet(writer_first: bool, kind: type[Channel[int]], promise: bool) -> None:
    channel, other = kind("c"), Channel[int]("other")
    offers = Alternative(Output(other, 0), Output(channel, 5))
    accepts = Alternative(Input(Channel[int]("never")), Ready(channel) if promise else Input(channel))
    log: list[Any] = []

    async def writer() -> None:
        log.append(("writer", await offers.select()))

    async def reader() -> None:
        index = await accepts.select()
        log.append(("reader", index, await channel.read() if promise else accepts.value))

    async def top() -> None:
        await (parallel(writer(), reader()) if writer_first else parallel(reader(), writer()))

    assert traced(top) == [(0, "c", 5)]
    assert sorted(log, key=str) == [("reader", 1, 5), ("writer", 1)]


def test_the_alternative_that_chooses_resolves_the_other_although_that_was_ready_for_something_else() -> None:
    a, b = Channel[int]("a"), Channel[int]("b")
    reading = Alternative(Input(a), Input(b), prioritized=True)
    writing = Alternative(Output(b, 7))
    log: list[Any] = []

    async def reader() -> None:
        log.append((await reading.select(), reading.value))
        log.append((await reading.select(), reading.value))

    async def top() -> None:
        await parallel(reader(), a.write(1), writing.select())

    finish(top)
    assert log == [(1, 7), (0, 1)]


def test_a_committed_writer_continues_only_when_its_value_was_read() -> None:
    channel, other = Channel[int]("c"), Channel[int]("other")
    writing = Alternative(Output(channel, 7), Output(other, 8))
    reading = Alternative(Ready(channel))
    log: list[str] = []

    async def writer() -> None:
        await writing.select()
        log.append("writer continues")

    async def reader() -> None:
        await reading.select()
        await wait(ms)
        log.append(f"reads {await channel.read()}")

    async def steals() -> None:
        await other.read()
        log.append("never")

    async def top() -> None:
        await parallel(writer(), reader(), steals())

    assert run(top).ended == "deadlock"
    assert log == ["reads 7", "writer continues"]


def test_ready_leaves_the_value_to_the_guarded_process() -> None:
    channel = Channel[int]("c")
    choice = Alternative(Ready(channel))

    async def reader() -> None:
        assert await choice.select() == 0
        assert await channel.read() == 3

    async def top() -> None:
        await parallel(reader(), channel.write(3))

    assert len(traced(top)) == 1


def test_guards_on_every_kind_of_channel() -> None:
    buffer, broadcast, variable = Buffer[int]("buffer", 1), Broadcast[int]("broadcast"), Variable[int]("variable", 9)
    end = broadcast.reader()

    async def top() -> None:
        assert await Alternative(Input(buffer), Skip(), prioritized=True).select() == 1
        assert await Alternative(Output(buffer, 1), Skip(), prioritized=True).select() == 0
        assert await Alternative(Output(buffer, 2), Skip(), prioritized=True).select() == 1
        choice = Alternative(Input(buffer), Skip(), prioritized=True)
        assert await choice.select() == 0
        assert choice.value == 1
        choice = Alternative(Input(variable), prioritized=True)
        assert await choice.select() == 0
        assert choice.value == 9
        choice = Alternative(Input(Constant(4)))
        await choice.select()
        assert choice.value == 4

        async def takes() -> None:
            choice = Alternative(Input(end))
            await choice.select()
            assert choice.value == 6

        await parallel(takes(), broadcast.write(6))
        await parallel(takes(), Alternative(Output(broadcast, 6)).select())
        await parallel(Alternative(Output(broadcast, 6)).select(), takes())
        await parallel(end.read(), Alternative(Output(broadcast, 6)).select())

    finish(top)


def test_an_alternative_that_is_gone_leaves_nothing_behind_in_its_channels() -> None:
    channel = Channel[int]("c")

    async def top() -> None:
        for _ in range(100):
            await Alternative(Input(channel), Skip()).select()

    finish(top)
    gc.collect()
    assert channel._meeting is not None
    assert channel._meeting.inputs == ()


def test_a_thousand_guards() -> None:
    channels = [Channel[int](str(index)) for index in range(1000)]
    choice = Alternative(*(Input(channel) for channel in channels))
    chosen: list[int] = []

    async def reader() -> None:
        for _ in channels:
            chosen.append(await choice.select())

    async def top() -> None:
        await parallel(reader(), *(channel.write(0) for channel in channels))

    finish(top)
    assert chosen == list(range(1000))
