"""Generated code as the runtime sees it: generator functions that access the slots of rendezvous channels."""

from __future__ import annotations

import pytest

from cspdiag.runtime import (
    After,
    Alternated,
    Alternative,
    Fault,
    Input,
    Network,
    Rendezvous,
    Rounds,
    Steps,
    Task,
    begin_delay,
    interrupted,
    ms,
    parallel,
)
from tests.runtime.compiled.programs import (
    CHANNELS,
    AnyChannel,
    Body,
    CheckedProgram,
    Program,
    failing,
    offer,
    reader,
    run,
    waits,
    write,
    writer,
)


@pytest.mark.parametrize("kind", CHANNELS)
@pytest.mark.parametrize("writer_first", [True, False])
def test_values_pass_in_order_whichever_party_is_first(writer_first: bool, kind: type[AnyChannel]) -> None:
    channel, got = kind("c"), list[int]()
    branches = [writer(channel, 1, 2, 3), reader(channel, got, 3)]
    outcome = run(*(branches if writer_first else branches[::-1]))
    assert (outcome.ended, got) == ("terminated", [1, 2, 3])


def choosing(alternative: Alternative, channels: list[Alternated[int]], got: list[int], count: int) -> Body:
    """A reader that chooses as generated code does, with all guards enabled and by priority."""

    def steps(me: Task) -> Steps:
        guards = alternative.selector
        for _ in range(count):
            ready = guards.ready
            while not ready:
                alternative.park(me, -1)
                yield
                guards.waiting = None
                ready = guards.ready
            k = (ready & -ready).bit_length() - 1
            channel = channels[k]
            party, channel.writing = channel.writing, None
            got.append(channel.offered)
            if channel.selector is guards:
                guards.ready ^= channel.bit
            else:
                channel.lower()
            me.scheduler.queue.append(party.entry)

    return steps


def test_alternative_takes_the_first_ready_guard_and_wakes_its_writer() -> None:
    channels, got = [Alternated[int](f"c{number}") for number in range(3)], list[int]()
    choice = Alternative(*map(Input, channels), prioritized=True)
    outcome = run(choosing(choice, channels, got, 4), writer(channels[2], 20, 21), writer(channels[0], 1, 2))
    assert (outcome.ended, got) == ("terminated", [1, 20, 2, 21])


def test_a_plain_read_takes_the_value_from_under_an_alternative() -> None:
    """The bit of the channel is cleared: the alternative, which comes later, does not find a writer that is gone."""
    channel, other = Alternated[int]("c"), Alternated[int]("d")
    choice, plain, got = Alternative(Input(channel), Input(other)), list[int](), list[int]()
    outcome = run(
        writer(channel, 1), reader(channel, plain, 1), choosing(choice, [channel, other], got, 1), writer(other, 2)
    )
    assert (outcome.ended, plain, got) == ("terminated", [1], [2])


def test_two_alternatives_on_one_channel_both_see_the_writer() -> None:
    channel, got = Alternated[int]("c"), list[int]()
    first, second = Alternative(Input(channel)), Alternative(Input(channel))
    assert channel.selector not in (first.selector, second.selector)
    outcome = run(choosing(first, [channel], got, 1), writer(channel, 7, 8), choosing(second, [channel], got, 1))
    assert (outcome.ended, got) == ("terminated", [7, 8])
    assert first.selector.ready == second.selector.ready == 0


@pytest.mark.parametrize("kind", CHANNELS)
def test_siblings_of_a_failure_are_withdrawn_from_their_channels(kind: type[AnyChannel]) -> None:
    """A reader or a writer that comes later does not find them."""
    first, second, got = kind("a"), kind("b"), list[int]()

    def body(me: Task) -> Steps:
        me.scheduler.current = me
        with pytest.raises(Fault, match="no"):
            yield from parallel(writer(first, 1), reader(second, got, 1), failing("no"))
        assert not waits(first)
        me.scheduler.current = me
        late = (reader(first, got, 1), reader(second, got, 1), writer(second, 2), writer(first, 3))
        yield from parallel(*late)

    outcome = Network(Program(body)).run()
    assert (outcome.ended, outcome.error, got) == ("terminated", None, [2, 3])


def two_at_once(first: AnyChannel, second: AnyChannel, ended: list[str]) -> Body:
    """Offers two values at once, and waits for both."""

    def steps(me: Task) -> Steps:
        offer(me, first, 1)
        offer(me, second, 1)
        try:
            yield
            yield
        finally:
            ended.append("both")

    return steps


@pytest.mark.parametrize("kind", CHANNELS)
def test_a_process_with_one_of_two_communications_done_is_abandoned_once(kind: type[AnyChannel]) -> None:
    """The completed communication has put the process into the ready queue, where it is no longer found."""
    first, second, got, ended = kind("a"), kind("b"), list[int](), list[str]()
    outcome = run(two_at_once(first, second, ended), reader(first, got, 1), failing("no"))
    assert (outcome.ended, got, ended) == ("failed", [1], ["both"])
    assert not waits(second)


def continues(channel: Rendezvous[int], seen: list[str]) -> Body:
    """Is made ready, and records that it continues after that."""

    def steps(me: Task) -> Steps:
        yield from write(me, channel, 1)
        seen.append("continued")

    return steps


@pytest.mark.parametrize(("program", "seen"), [(Program, []), (CheckedProgram, ["continued"])])
def test_a_ready_process_when_cancelled_continues_only_if_it_is_checked(
    program: type[Program], seen: list[str]
) -> None:
    channel, got, reported = Rendezvous[int]("c"), list[int](), list[str]()

    def takes_and_fails(me: Task) -> Steps:
        yield from reader(channel, got, 1)(me)
        raise Fault("no")

    outcome = run(continues(channel, reported), takes_and_fails, program=program)
    assert (outcome.ended, reported) == ("failed", seen)


@pytest.mark.parametrize("kind", CHANNELS)
def test_an_interrupt_withdraws_its_body(kind: type[AnyChannel]) -> None:
    channel, result = kind("c"), list[object]()

    def body(me: Task) -> Steps:
        me.scheduler.current = me
        taken = yield from interrupted(writer(channel, 1), After(5 * ms))
        result.extend([taken, me.scheduler.now, waits(channel)])

    Network(CheckedProgram(body)).run()
    assert result == [True, 5 * ms, False]


def test_rounds_keep_their_tasks_and_begin_anew_after_a_failure() -> None:
    trace: list[object] = []

    def body(me: Task) -> Steps:
        def first(me: Task) -> Steps:
            while True:
                trace.append("first")
                rounds.done(me)
                yield

        def second(me: Task) -> Steps:
            while True:
                begin_delay(me, 1 * ms)
                yield
                trace.append(me.scheduler.now)
                if me.scheduler.now == 2 * ms:
                    raise Fault("no")
                rounds.done(me)
                yield

        rounds = Rounds(me, first, second)
        for _ in range(3):
            rounds.begin()
            yield
            if rounds.failed:
                with pytest.raises(Fault):
                    rounds.conclude()

    assert Network(Program(body)).run().ended == "terminated"
    assert trace == ["first", 1 * ms, "first", 2 * ms, "first", 3 * ms]


@pytest.mark.parametrize("kind", CHANNELS)
def test_a_deadlock_is_reported_with_the_channels_in_which_the_code_waits(kind: type[AnyChannel]) -> None:
    first, second, got = kind("Top.a"), kind("Top.b"), list[int]()

    def one(me: Task) -> Steps:
        yield from write(me, first, 1)
        yield from reader(second, got, 1)(me)

    def other(me: Task) -> Steps:
        yield from write(me, second, 1)
        yield from reader(first, got, 1)(me)

    deadlock = run(one, other).deadlock
    assert deadlock is not None
    assert [process.waits for process in deadlock.cycle] == ["to write Top.a", "to write Top.b"]


@pytest.mark.parametrize("kind", CHANNELS)
def test_a_reader_that_was_served_before_waits_to_read(kind: type[AnyChannel]) -> None:
    channel, got = kind("Top.a"), list[int]()
    deadlock = run(writer(channel, 1, 2), reader(channel, got, 3)).deadlock
    assert deadlock is not None
    assert [process.waits for process in deadlock.waiting] == ["to read Top.a"]
