"""Several runs in one process, at the same time: each has its own processes, time and observers."""

from __future__ import annotations

import threading
from collections.abc import Callable

from cspdiag.runtime import (
    After,
    Alternative,
    Broadcast,
    Buffer,
    Channel,
    EventOutput,
    Input,
    Network,
    Outcome,
    Policy,
    SampledInput,
    ms,
    now,
    parallel,
    wait,
)
from tests.runtime.support import Body, Scripted, Trace

ROUNDS = 300


def _network(first: int, meet: Callable[[], object] = lambda: None) -> tuple[Network, Trace, list[object], Scripted]:
    """A program with channels, delays and samples; its values begin at ``first``, and it calls ``meet`` in the middle
    of each iteration.
    """
    environment = Scripted({"x": {0: first, 5 * ms: first + 1}}, ["y"])
    x = SampledInput[int]("x", period=1 * ms, driver=environment.drivers["x"])
    y = EventOutput[int]("y", driver=environment.drivers["y"])
    a, b, c = Channel[int]("a"), Buffer[int]("b"), Broadcast[int]("c")
    end = x.reader()
    seen: list[object] = []

    async def source() -> None:
        for number in range(first, first + ROUNDS):
            await a.write(number)
            meet()
            await end.read()

    async def middle() -> None:
        choice = Alternative(Input(a), After(10 * ms))
        for _ in range(ROUNDS):
            await choice.select()
            await b.write(choice.value)

    async def sink() -> None:
        for _ in range(ROUNDS):
            value = await b.read()
            await y.write(value)
            await parallel(c.write(value), left.read(), right.read(), wait(0))
            seen.append((now(), value))

    left, right = c.reader(), c.reader()
    trace = Trace()
    return Network(Body(lambda: parallel(source(), middle(), sink())), [x, y]), trace, seen, environment


def _alone(first: int) -> tuple[list[object], list[object], int]:
    network, trace, seen, environment = _network(first)
    outcome = network.run(environment, observer=trace)
    assert outcome.ended == "terminated", outcome
    return list(trace.communications), seen, outcome.time


def test_two_threads_run_one_network_each() -> None:
    expected = [_alone(0), _alone(1000)]
    together = threading.Barrier(2, timeout=20)
    outcomes: dict[int, Outcome] = {}
    # They wait for each other in the middle of every iteration, so both are always running.
    programs = [_network(first, together.wait) for first in (0, 1000)]

    def run(number: int) -> None:
        network, trace, _, environment = programs[number]
        outcomes[number] = network.run(environment, observer=trace)

    threads = [threading.Thread(target=run, args=(number,)) for number in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(30)
    for number, (_, trace, seen, _) in enumerate(programs):
        assert (list(trace.communications), seen, outcomes[number].time) == expected[number]


def test_a_process_runs_a_network_and_continues_in_its_own() -> None:
    expected = [_alone(0), _alone(1000)]
    inner: list[object] = []

    def meet() -> None:
        if not inner:
            network, trace, seen, environment = _network(1000)
            outcome = network.run(environment, observer=trace)
            inner.append((list(trace.communications), seen, outcome.time))

    network, trace, seen, environment = _network(0, meet)
    outcome = network.run(environment, observer=trace)
    assert (list(trace.communications), seen, outcome.time) == expected[0]
    assert inner == [expected[1]]


def test_a_run_without_a_policy_runs_inside_one_that_has_one() -> None:
    class Counting(Policy):
        questions = 0

        def next(self, ready: object) -> int:
            self.questions += 1
            return 0

    questions: list[int] = []

    def meet() -> None:
        if not questions:
            before = policy.questions
            assert _alone(1000)[2] > 0
            questions.append(policy.questions - before)

    policy = Counting()
    network, trace, seen, environment = _network(0, meet)
    outcome = network.run(environment, observer=trace, policy=policy)
    assert (list(trace.communications), seen, outcome.time) == _alone(0)
    assert questions == [0]
    assert policy.questions > ROUNDS


def test_channels_are_those_of_the_run_that_uses_them_now() -> None:
    channel = Channel[int]("kept")
    got: list[object] = []

    async def reads() -> None:
        for _ in range(2):
            got.append((await channel.read(), now()))

    async def writes(after: int) -> None:
        await wait(after)
        await channel.write(after)
        await channel.write(after)

    for after in (1 * ms, 2 * ms):
        Network(Body(lambda after=after: parallel(reads(), writes(after)))).run().raise_if_unsuccessful()
    assert got == [(1 * ms, 1 * ms)] * 2 + [(2 * ms, 2 * ms)] * 2


def test_one_network_runs_once_at_a_time() -> None:
    async def again() -> None:
        network.run()

    network = Network(Body(again))
    outcome = network.run()
    assert isinstance(outcome.error, RuntimeError)
    assert "running already" in str(outcome.error)
    # It can be run again.
    assert isinstance(network.run().error, RuntimeError)
