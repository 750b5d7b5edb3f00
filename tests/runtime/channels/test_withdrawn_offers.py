"""Channels know the processes that wait there, and forget those that stop waiting: readers, writers and alternatives
that are interrupted or choose something else.
"""

from __future__ import annotations

import pytest

from cspdiag.runtime import (
    After,
    Alternative,
    AnyChannel,
    Broadcast,
    Buffer,
    Channel,
    Input,
    Output,
    Skip,
    interrupt,
    ms,
    parallel,
    read_all,
    wait,
)
from tests.runtime.support import finish, traced


async def nothing() -> None:
    pass


def test_a_buffer_keeps_what_an_interrupted_reader_did_not_take() -> None:
    channel = Buffer[int]("b", 1)
    log: list[int] = []

    async def top() -> None:
        await interrupt(channel.read(), After(ms), nothing)
        await channel.write(7)
        log.append(await channel.read())

    finish(top)
    assert log == [7]


def test_the_value_of_an_interrupted_writer_does_not_enter_a_buffer() -> None:
    channel = Buffer[int]("b", 1)

    async def top() -> None:
        await channel.write(1)
        await interrupt(channel.write(2), After(ms), nothing)
        await channel.read()
        await channel.write(3)

    assert traced(top) == [(0, "b", 1), (ms, "b", 3)]


def test_an_output_guard_on_a_buffer_is_ready_while_there_is_room() -> None:
    channel = Buffer[int]("b", 2)
    chosen: list[int] = []

    async def top() -> None:
        choice = Alternative(Output(channel, 1), Skip(), prioritized=True)
        for _ in range(3):
            chosen.append(await choice.select())
        await channel.read()
        for _ in range(2):
            chosen.append(await choice.select())

    finish(top)
    assert chosen == [0, 0, 1, 0, 1]


@pytest.mark.parametrize("kind", [Channel, AnyChannel])
def test_an_offer_of_an_interrupted_writer_is_not_read(kind: type[Channel[int]]) -> None:
    channel = kind("c")
    chosen: list[int] = []

    async def top() -> None:
        choice = Alternative(Input(channel), Skip(), prioritized=True)
        await interrupt(channel.write(1), After(ms), nothing)
        chosen.append(await choice.select())

    assert traced(top) == []
    assert chosen == [1]


@pytest.mark.parametrize("kind", [Channel, AnyChannel])
@pytest.mark.parametrize("side", ["reads", "writes"])
def test_an_alternative_that_chose_another_guard_is_not_a_partner(kind: type[Channel[int]], side: str) -> None:
    channel = kind("c")
    left, right = (Input(channel), Output(channel, 1)) if side == "reads" else (Output(channel, 1), Input(channel))
    chosen: list[int] = []

    async def leaves() -> None:
        chosen.append(await Alternative(left, After(ms)).select())

    async def comes() -> None:
        choice = Alternative(right, Skip(), prioritized=True)
        await wait(2 * ms)
        chosen.append(await choice.select())

    async def top() -> None:
        await parallel(leaves(), comes())

    assert traced(top) == []
    assert chosen == [1, 1]


def test_a_writer_stays_when_an_alternative_next_to_it_withdraws() -> None:
    """The guard of the reader is ready as long as one of the two writers waits."""
    channel = AnyChannel[int]("c")
    chosen: list[int] = []

    async def leaves() -> None:
        await Alternative(Output(channel, 1), After(ms)).select()

    async def stays() -> None:
        await Alternative(Output(channel, 2), After(9 * ms)).select()

    async def reads() -> None:
        choice = Alternative(Input(channel), Skip(), prioritized=True)
        await wait(2 * ms)
        chosen.append(await choice.select())

    async def top() -> None:
        await parallel(leaves(), stays(), reads())

    assert traced(top) == [(2 * ms, "c", 2)]
    assert chosen == [0]


def test_an_alternative_made_after_a_broadcast_was_offered_can_take_it() -> None:
    channel = Broadcast[int]("b")
    end = channel.reader()
    chosen: list[int] = []

    async def reads() -> None:
        await wait(ms)
        chosen.append(await Alternative(Input(end), Skip(), prioritized=True).select())

    async def top() -> None:
        await parallel(channel.write(5), reads())

    finish(top)
    assert chosen == [0]


def test_an_output_guard_is_ready_for_a_process_that_reads_several_inputs_at_once() -> None:
    first, second = Channel[int]("first"), Channel[int]("second")

    async def reads() -> None:
        await wait(ms)
        assert await read_all(first, second) == (1, 2)

    async def writes() -> None:
        assert await Alternative(Output(first, 1), After(5 * ms)).select() == 0
        await second.write(2)

    async def top() -> None:
        await parallel(reads(), writes())

    assert traced(top) == [(ms, "first", 1), (ms, "second", 2)]
