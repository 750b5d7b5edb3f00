"""Generators that stand in the ready queue themselves: how they end, fail and are cancelled there."""

from __future__ import annotations

from typing import Any

import pytest

from cspdiag.runtime import (
    Alternated,
    Cancelled,
    Fault,
    Input,
    Network,
    Rendezvous,
    Rounds,
    Steps,
    Task,
    begin_delay,
    interrupted,
    parallel,
)
from cspdiag.runtime.compiled.direct import FEW
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
    write,
    writer,
)

MANY = 5000
"""More than the scheduler takes from the queue at a time."""


@pytest.mark.parametrize("count", [1, FEW - 1, FEW, FEW + 1, MANY])
def test_all_that_are_ready_run_in_order_and_end(count: int) -> None:
    trace = list[int]()

    def noting(number: int) -> Body:
        def steps(me: Task) -> Steps:
            trace.append(number)
            yield from ()

        return steps

    assert run(*map(noting, range(count))).ended == "terminated"
    assert trace == list(range(count))


@pytest.mark.parametrize("count", [FEW // 2, 2 * FEW])
def test_pairs_communicate_until_all_have_ended(count: int) -> None:
    channels = [Rendezvous[int](f"c{number}") for number in range(count)]
    got = [list[int]() for _ in channels]
    pairs = zip(channels, got, strict=True)
    branches = [branch for channel, into in pairs for branch in (writer(channel, 1, 2), reader(channel, into, 2))]
    assert run(*branches).ended == "terminated"
    assert got == [[1, 2]] * count


def waiting(channel: Rendezvous[Any], ended: list[str], name: str) -> Body:
    def steps(me: Task) -> Steps:
        try:
            yield from reader(channel, [], 1)(me)
            ended.append(f"{name} continued")
        except BaseException as error:
            ended.append(f"{name} {type(error).__name__}")
            raise

    return steps


@pytest.mark.parametrize("before", [0, 2 * FEW])
def test_those_that_a_failure_cancels_are_abandoned_once_whether_they_wait_or_are_ready(before: int) -> None:
    """``before``: how many run before them, so that the failure is in the loop in C or in that in Python."""
    first, second, ended = Rendezvous[int]("a"), Rendezvous[int]("b"), list[str]()
    others = [writer(Rendezvous[int](f"c{number}"), 1) for number in range(before)]
    branches = [waiting(first, ended, "first"), waiting(second, ended, "second"), writer(first, 1), failing("no")]
    outcome = run(*others, *branches)
    assert (outcome.ended, str(outcome.error)) == ("failed", "no, in Top")
    assert ended == ["first Cancelled", "second Cancelled"]


def both(first: AnyChannel, second: AnyChannel, ended: list[str]) -> Body:
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


def nested(depth: int, trace: list[str]) -> Body:
    """Waits for a branch that waits for a branch, so that it ends later than those that are cancelled with it."""

    def steps(me: Task) -> Steps:
        try:
            me.scheduler.current = me
            yield from parallel(nested(depth - 1, []) if depth else reader(Rendezvous[int]("never"), [], 1))
        finally:
            trace.append("nested")

    return steps


class TrackedProgram(Program):
    tracked = True


@pytest.mark.parametrize("kind", CHANNELS)
@pytest.mark.parametrize("program", [Program, TrackedProgram])
def test_one_of_which_both_communications_are_done_is_abandoned_once(
    program: type[Program], kind: type[AnyChannel]
) -> None:
    """It is in the ready queue twice; its parallel still waits for the others."""
    first, second, trace = kind("a"), kind("b"), list[str]()

    def body(me: Task) -> Steps:
        late = (both(first, second, trace), reader(first, [], 1), reader(second, [], 1), failing("no"))
        me.scheduler.current = me
        with pytest.raises(Fault):
            yield from parallel(nested(5, trace), *map(delayed, late))
        trace.append("parallel")

    assert Network(program(body)).run().ended == "terminated"
    assert trace == ["both", "nested", "parallel"]


@pytest.mark.parametrize("before", [0, 2 * FEW])
def test_an_interrupt_cancels_a_body_that_is_ready(before: int) -> None:
    channel, stop, trace = Rendezvous[int]("c"), Alternated[int]("stop"), list[object]()

    def interruptible(me: Task) -> Steps:
        yield from reader(channel, trace, 1)(me)
        if me.cancelled:
            trace.append("cancelled")
            raise Cancelled

    def interrupting(me: Task) -> Steps:
        me.scheduler.current = me
        trace.append((yield from interrupted(interruptible, Input(stop))))

    def writing(me: Task) -> Steps:
        begin_delay(me, 1)
        yield
        yield from write(me, channel, 1)
        yield from write(me, stop, 2)

    others = [delayed(writer(Rendezvous[int]("none"))) for _ in range(before)]
    assert run(*others, writing, interrupting, program=CheckedProgram).ended == "terminated"
    assert trace == [1, "cancelled", True]


def two_reads(first: Rendezvous[int], second: Rendezvous[int], trace: list[object]) -> Body:
    """Reads two values at once, as checked code does."""

    def steps(me: Task) -> Steps:
        for channel in (first, second):
            channel.reading = me
        waiting = 2
        while waiting:
            yield
            waiting -= 1
        trace.append((first.value, second.value))
        if me.cancelled:
            raise Cancelled

    return steps


@pytest.mark.parametrize("before", [0, 2 * FEW])
def test_an_interrupt_cancels_a_body_of_which_both_communications_are_done(before: int) -> None:
    """It is in the ready queue twice, and continues when it has been resumed twice."""
    first, second, stop, trace = Rendezvous[int]("a"), Rendezvous[int]("b"), Alternated[int]("stop"), list[object]()

    def interrupting(me: Task) -> Steps:
        me.scheduler.current = me
        trace.append((yield from interrupted(two_reads(first, second, trace), Input(stop))))

    def writing(me: Task) -> Steps:
        for channel, value in ((first, 1), (second, 2), (stop, 3)):
            yield from write(me, channel, value)

    others = [delayed(writer(Rendezvous[int]("none"))) for _ in range(before)]
    assert run(*others, delayed(writing), interrupting, program=CheckedProgram).ended == "terminated"
    assert trace == [(1, 2), True]


def delayed(body: Body) -> Body:
    def steps(me: Task) -> Steps:
        begin_delay(me, 1)
        yield
        yield from body(me)

    return steps


def test_rounds_that_fail_leave_no_task_behind() -> None:
    left = list[int]()

    def body(me: Task) -> Steps:
        def first(me: Task) -> Steps:
            while True:
                rounds.done(me)
                yield

        rounds = Rounds(me, first, failing("no"))
        for _ in range(3):
            rounds.begin()
            yield
            with pytest.raises(Fault):
                rounds.conclude()
            left.append(len(me.scheduler.tasks))  # type: ignore[attr-defined]

    assert run(body).ended == "terminated"
    assert left == [2, 2, 2]
