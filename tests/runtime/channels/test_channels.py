"""Channels of all kinds, read and written plainly."""

from __future__ import annotations

import pytest

from cspdiag.runtime import (
    AnyChannel,
    Broadcast,
    Buffer,
    Channel,
    ChannelMisuse,
    Constant,
    Discard,
    Fault,
    Overwriting,
    Variable,
    ms,
    parallel,
    read_all,
    wait,
    write_all,
)
from tests.runtime.support import finish, run, traced


def test_the_writer_continues_only_when_the_reader_has_arrived() -> None:
    channel = Channel[int]("c")
    log: list[str] = []

    async def writer() -> None:
        log.append("writes")
        await channel.write(1)
        log.append("written")

    async def reader() -> None:
        await wait(5 * ms)
        log.append("reads")
        log.append(f"took {await channel.read()}")

    async def top() -> None:
        await parallel(writer(), reader())

    finish(top)
    assert log == ["writes", "reads", "took 1", "written"]


def test_the_second_party_continues_and_the_first_is_queued() -> None:
    channel = Channel[int]("c")
    log: list[str] = []

    async def reader() -> None:
        for _ in range(2):
            await channel.read()
            log.append("reader")

    async def writer() -> None:
        for value in range(2):
            await channel.write(value)
            log.append("writer")

    async def top() -> None:
        await parallel(reader(), writer())

    finish(top)
    assert log == ["writer", "reader", "reader", "writer"]


def test_a_value_handed_over_is_not_overwritten_by_the_next_offer() -> None:
    channel = Channel[int]("c")
    taken: list[int] = []

    async def reader() -> None:
        for _ in range(10):
            taken.append(await channel.read())

    async def writer() -> None:
        for value in range(10):
            await channel.write(value)

    async def top() -> None:
        await parallel(reader(), writer())

    finish(top)
    assert taken == list(range(10))


@pytest.mark.parametrize("side", ["read", "write"])
def test_two_processes_at_one_end_of_a_channel_are_refused(side: str) -> None:
    channel = Channel[int]("Top.c")

    async def use() -> None:
        await (channel.read() if side == "read" else channel.write(1))

    async def top() -> None:
        await parallel(use(), use())

    outcome = run(top)
    assert outcome.ended == "failed"
    assert isinstance(outcome.error, ChannelMisuse)
    assert "Top.c" in str(outcome.error)


def test_any_serves_writers_and_readers_first_come_first_served() -> None:
    channel = AnyChannel[int]("c")
    taken: list[tuple[str, int]] = []

    async def writer(value: int) -> None:
        await channel.write(value)
        await channel.write(value + 10)

    async def reader(name: str) -> None:
        for _ in range(3):
            taken.append((name, await channel.read()))

    async def top() -> None:
        await parallel(writer(1), writer(2), writer(3), reader("a"), reader("b"))

    finish(top)
    assert sorted(value for _, value in taken) == [1, 2, 3, 11, 12, 13]
    assert [value for _, value in taken][:3] == [1, 2, 3]


def test_a_buffer_blocks_its_writer_only_while_it_is_full() -> None:
    channel = Buffer[int]("b", 2)
    log: list[str] = []

    async def writer() -> None:
        for value in range(4):
            await channel.write(value)
            log.append(f"wrote {value}")

    async def reader() -> None:
        await wait(ms)
        for _ in range(4):
            log.append(f"read {await channel.read()}")

    async def top() -> None:
        await parallel(writer(), reader())

    finish(top)
    assert log[:2] == ["wrote 0", "wrote 1"]
    assert [entry for entry in log if entry.startswith("read")] == ["read 0", "read 1", "read 2", "read 3"]
    assert log.index("read 0") < log.index("wrote 2")


def test_a_buffer_communicates_when_the_value_enters() -> None:
    channel = Buffer[int]("b", 1)

    async def writer() -> None:
        await channel.write(1)
        await channel.write(2)

    async def reader() -> None:
        await wait(3 * ms)
        await channel.read()
        await wait(3 * ms)
        await channel.read()

    async def top() -> None:
        await parallel(writer(), reader())

    assert traced(top) == [(0, "b", 1), (3 * ms, "b", 2)]


def test_an_overwriting_channel_drops_the_oldest() -> None:
    channel = Overwriting[int]("o", 3)
    taken: list[int] = []

    async def top() -> None:
        for value in range(5):
            await channel.write(value)
        for _ in range(3):
            taken.append(await channel.read())

    finish(top)
    assert taken == [2, 3, 4]


def test_a_broadcast_reaches_every_end_and_its_writer_waits_for_the_last() -> None:
    channel = Broadcast[int]("b")
    ends = [channel.reader(), channel.reader(), channel.reader()]
    log: list[str] = []

    async def writer() -> None:
        for value in range(2):
            await channel.write(value)
            log.append(f"wrote {value}")

    async def reader(index: int) -> None:
        await wait(index * ms)
        for _ in range(2):
            log.append(f"{index} took {await ends[index].read()}")

    async def top() -> None:
        await parallel(writer(), *(reader(index) for index in range(3)))

    finish(top)
    assert log.index("wrote 0") > log.index("2 took 0")
    assert [entry for entry in log if entry.endswith("took 1")] == ["0 took 1", "1 took 1", "2 took 1"]


def test_a_broadcast_to_waiting_readers_lets_the_writer_continue() -> None:
    channel = Broadcast[int]("b")
    ends = [channel.reader(), channel.reader()]

    async def top() -> None:
        async def writer() -> None:
            await wait(ms)
            await channel.write(7)

        await parallel(ends[0].read(), ends[1].read(), writer())

    assert traced(top) == [(ms, "b", 7), (ms, "b", 7)]


def test_variables_never_wait_and_are_in_no_trace() -> None:
    variable = Variable[int]("v")

    async def top() -> None:
        await variable.write(4)
        assert await variable.read() == 4
        assert await variable.read() == variable.value == 4

    assert traced(top) == []


def test_reading_a_variable_before_it_was_written_is_a_fault() -> None:
    variable = Variable[int]("Top.status")

    async def top() -> None:
        await variable.read()

    outcome = run(top)
    assert isinstance(outcome.error, Fault)
    assert "Top.status is read before it was written, in Top" in str(outcome.error)


def test_constants_and_the_discarding_sink_never_wait() -> None:
    async def top() -> None:
        assert await Constant(2.5).read() == 2.5
        await Discard().write(1)
        assert await read_all(Constant(1), Constant(2)) == (1, 2)

    finish(top)


def test_read_all_offers_every_input_at_once() -> None:
    first, second = Channel[int]("first"), Channel[int]("second")
    taken: list[tuple[int, int]] = []

    async def reader() -> None:
        taken.append(await read_all(first, second))

    async def writer() -> None:
        await second.write(2)  # the order of the ports must not matter
        await first.write(1)

    async def top() -> None:
        await parallel(reader(), writer())

    finish(top)
    assert taken == [(1, 2)]


def test_write_all_offers_every_output_at_once() -> None:
    first, second = Channel[int]("first"), Channel[int]("second")
    taken: list[int] = []

    async def reader() -> None:
        taken.append(await second.read())
        await wait(ms)
        taken.append(await first.read())

    async def top() -> None:
        await parallel(write_all((first, 1), (second, 2)), reader())

    assert [channel for _, channel, _ in traced(top)] == ["second", "first"]
    assert taken == [2, 1]


def test_two_parties_that_read_and_write_all_at_once_cannot_deadlock() -> None:
    there, back = Channel[int]("there"), Channel[int]("back")

    async def node(output: Channel[int], source: Channel[int]) -> None:
        for value in range(3):
            await parallel(output.write(value), source.read())

    async def top() -> None:
        await parallel(node(there, back), node(back, there))

    assert len(traced(top)) == 6
