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
)
from tests.runtime.compiled.programs import Body, CheckedProgram, Program, failing, reader, run, write, writer


@pytest.mark.parametrize("writer_first", [True, False])
def test_values_pass_in_order_whichever_party_is_first(writer_first: bool) -> None:
    channel, got = Rendezvous[int]("c"), list[int]()
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


def test_siblings_of_a_failure_are_withdrawn_from_their_channels() -> None:
    channel = Rendezvous[int]("c")
    outcome = run(writer(channel, 1), failing("no"))
    assert (outcome.ended, str(outcome.error)) == ("failed", "no, in Top")
    assert channel.writing is None


def two_at_once(first: Rendezvous[int], second: Rendezvous[int], ended: list[str]) -> Body:
    """Offers two values at once, and waits for both."""

    def steps(me: Task) -> Steps:
        for channel in (first, second):
            channel.writing = me
            channel.offered = 1
        try:
            yield
            yield
        finally:
            ended.append("both")

    return steps


def test_a_process_with_one_of_two_communications_done_is_abandoned_once() -> None:
    """The completed communication has put the process into the ready queue, where it is no longer found."""
    first, second, got, ended = Rendezvous[int]("a"), Rendezvous[int]("b"), list[int](), list[str]()
    outcome = run(two_at_once(first, second, ended), reader(first, got, 1), failing("no"))
    assert (outcome.ended, got, ended) == ("failed", [1], ["both"])
    assert second.writing is None


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


def test_an_interrupt_withdraws_its_body() -> None:
    channel, result = Rendezvous[int]("c"), list[object]()

    def body(me: Task) -> Steps:
        me.scheduler.current = me
        taken = yield from interrupted(writer(channel, 1), After(5 * ms))
        result.extend([taken, me.scheduler.now, channel.writing])

    Network(CheckedProgram(body)).run()
    assert result == [True, 5 * ms, None]


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


def test_a_deadlock_is_reported_with_the_channels_in_which_the_code_waits() -> None:
    first, second, got = Rendezvous[int]("Top.a"), Rendezvous[int]("Top.b"), list[int]()

    def one(me: Task) -> Steps:
        yield from write(me, first, 1)
        yield from reader(second, got, 1)(me)

    def other(me: Task) -> Steps:
        yield from write(me, second, 1)
        yield from reader(first, got, 1)(me)

    deadlock = run(one, other).deadlock
    assert deadlock is not None
    assert [process.waits for process in deadlock.cycle] == ["to write Top.a", "to write Top.b"]
