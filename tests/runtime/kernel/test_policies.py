"""What a run leaves open is decided by its policy."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import Any, Literal

import pytest

from cspdiag.runtime import (
    After,
    Alternative,
    Channel,
    EventInput,
    EventOutput,
    Input,
    Network,
    Option,
    Policy,
    Routine,
    Skip,
    Submodel,
    Task,
    interrupt,
    ms,
    parallel,
    prioritized_parallel,
    read_all,
    stop,
    wait,
    write_all,
)
from cspdiag.runtime.advance.stepwise import StepwiseRun
from cspdiag.runtime.kernel.party import Party, Waits
from cspdiag.runtime.kernel.policy import Interruption
from cspdiag.runtime.outside.supply import Supply
from tests.runtime.support import Body, finish


class Last(Policy):
    """Takes the last of whatever there is."""

    def next(self, ready: Sequence[Party]) -> int:
        return len(ready) - 1

    def choose(self, task: Party, ready: Sequence[Option], *, prioritized: bool) -> int:
        return len(ready) - 1


def _order(policy: Policy | None) -> list[str]:
    done: list[str] = []

    async def branch(name: str) -> None:
        done.append(name)

    finish(lambda: parallel(*(branch(name) for name in "abc")), policy=policy)
    return done


def test_a_policy_decides_which_ready_process_is_next() -> None:
    assert _order(None) == _order(Policy()) == ["a", "b", "c"]
    assert _order(Last()) == ["c", "b", "a"]


def test_a_policy_chooses_within_the_highest_level_only() -> None:
    done: list[str] = []

    async def branch(name: str) -> None:
        done.append(name)

    async def program() -> None:
        await prioritized_parallel(parallel(branch("a"), branch("b")), parallel(branch("c"), branch("d")))

    finish(program, policy=Last())
    assert done == ["b", "a", "d", "c"]


def _chosen(policy: Policy | None) -> list[int]:
    async def program() -> None:
        choice = Alternative(Skip(), Skip(), Skip())
        for _ in range(4):
            chosen.append(await choice.select())

    chosen: list[int] = []
    finish(program, policy=policy)
    return chosen


def test_a_policy_decides_which_ready_guard_is_taken() -> None:
    assert _chosen(None) == _chosen(Policy()) == [0, 1, 2, 0]
    # The last one in the fair order is the one that was chosen last.
    assert _chosen(Last()) == [2, 2, 2, 2]


class Recorded(Policy):
    def __init__(self) -> None:
        self.what: list[tuple[object, ...]] = []

    def arrives(self, task: Party) -> None:
        self.what.append(("arrives",))

    def did(self, task: Party, option: Option) -> None:
        self.what.append((option.action, option.channel, option.index, option.duration))

    def took_part(self, party: Party, action: Literal["read", "write", "miss"], channel: str) -> None:
        self.what.append(("part", action, channel))

    def wrote(self, party: Party, channel: str, value: Any) -> None:
        self.what.append(("wrote", channel, value))

    def computes(self) -> None:
        self.what.append(("computes",))


class _Law(Submodel):
    def __init__(self, x: Channel[int], y: EventOutput[int]) -> None:
        super().__init__("Top.law")
        self.x, self.y = x, y

    async def run(self) -> None:
        (value,) = await read_all(self.x)
        await write_all((self.y, 2 * value))


def test_a_policy_is_notified_of_what_processes_do_and_when_laws_compute() -> None:
    reported = Recorded()
    x, y = Channel[int]("x"), EventOutput[int]("y")
    law = _Law(x, y)

    async def program() -> None:
        await wait(2 * ms)
        await Alternative(Input(x), After(3 * ms)).select()
        await parallel(law, x.write(1))
        await law_without_output

    class _Silent(Submodel):
        async def run(self) -> None:
            pass

    law_without_output = _Silent("Top.silent")
    finish(program, [y], policy=reported)
    assert reported.what == [
        ("wait", "", 0, 2 * ms), ("arrives",), ("after", "", 1, 3 * ms),
        ("write", "x", 0, 0), ("read", "x", 0, 0), ("computes",), ("wrote", "y", 2), ("write", "y", 0, 0),
        ("computes",),
    ]  # fmt: skip


class _Gate:
    """The state of a task of a ``_Halting`` policy."""

    chosen: Option | None = None

    def __init__(self, task: Any, options: Sequence[Option]) -> None:
        self.task, self.options = task, options

    def withdraw(self, party: Party) -> bool:
        return True

    def waits_for(self, party: Party) -> Waits:
        return ()


class _Halting(Policy):
    leads_interrupts = True

    def __init__(self) -> None:
        self.gates: list[_Gate] = []
        self.interruptions: list[Interruption] = []

    def halt(self, task: Party, options: Sequence[Option], *, together: bool) -> _Gate:
        self.gates.append(_Gate(task, options))
        return self.gates[-1]

    def interrupt_begins(self, interruption: Interruption) -> None:
        self.interruptions.append(interruption)

    def interrupt_ends(self, interruption: Interruption) -> None:
        self.interruptions.remove(interruption)

    def pass_(self, run: StepwiseRun, action: str, channel: str = "") -> None:
        """Lets the process continue that can do this."""
        ((gate, option),) = [
            (g, o) for g in self.gates for o in g.options if (o.action, o.channel) == (action, channel)
        ]
        self.gates.remove(gate)
        gate.chosen = option
        run.ready(gate.task)
        while run.run_ready(1):
            pass


def _started(body: Any, ports: Any = ()) -> tuple[_Halting, StepwiseRun, list[tuple[str, Any]]]:
    seen: list[tuple[str, Any]] = []
    policy = _Halting()
    run = StepwiseRun(Network(Body(body), ports), policy, lambda channel, value, _w, _r: seen.append((channel, value)))
    while run.run_ready(1):
        pass
    return policy, run, seen


def test_tasks_halt_and_continue_as_a_policy_decides() -> None:
    a, b = Channel[int]("a"), Channel[int]("b")
    got: list[object] = []

    async def reads() -> None:
        choice = Alternative(Input(a), Input(b), After(1 * ms), prioritized=True)
        got.append((await choice.select(), choice.value))
        got.append(await read_all(a, b))

    async def writes(channel: Channel[int]) -> None:
        await channel.write(1)
        await channel.write(2)

    async def program() -> None:
        await parallel(reads(), writes(a), writes(b))

    policy, run, seen = _started(program)
    assert not seen
    assert len(policy.gates) == 3
    policy.pass_(run, "write", "a")
    policy.pass_(run, "write", "b")
    policy.pass_(run, "read", "b")
    assert seen == [("b", 1)]
    assert got == [(1, 1)]
    policy.pass_(run, "read", "b")
    policy.pass_(run, "write", "b")
    policy.pass_(run, "read", "a")
    assert seen == [("b", 1), ("b", 2), ("a", 1)]
    assert got[1] == (1, 2)
    run.close()


def test_a_policy_decides_when_delays_end_and_interrupts_arrive() -> None:
    done: list[str] = []

    async def handler() -> None:
        done.append("handled")

    async def body() -> None:
        await wait(5 * ms)
        done.append("waited")
        await stop()

    async def program() -> None:
        await interrupt(body(), After(7 * ms), handler)

    policy, run, _ = _started(program)
    policy.pass_(run, "wait")
    assert done == ["waited"]
    assert run.now == 0
    (interruption,) = policy.interruptions
    assert interruption.option == Option("after", duration=7 * ms)
    interruption.come(taken=True)
    while run.run_ready(1):
        pass
    assert done == ["waited", "handled"]
    assert run.root.ended
    assert run.error is None
    assert not policy.interruptions
    run.close()


def test_a_supply_is_asked_when_a_process_reads() -> None:
    class Counting(Supply):
        count = 0

        def value(self, port: str, reader: Task) -> int:
            self.count += 1
            return self.count

    supply = Counting()
    source = EventInput[int]("in", driver=supply)
    end = source.reader()
    got: list[int] = []

    async def program() -> None:
        choice = Alternative(Input(end))
        while True:
            got.append(await end.read())
            await choice.select()
            got.append(choice.value)
            if len(got) == 4:
                supply.run_dry()

    run = StepwiseRun(Network(Body(program), [source]), Policy(), lambda *_: None)
    while run.run_ready(1):
        pass
    assert got == [1, 2, 3, 4]
    assert supply.count == 4
    assert not run.root.ended
    run.close()


def test_optimized_code_and_real_time_have_no_policy() -> None:
    class Fast(Routine):
        __slots__ = ()

        def steps(self, me: Task) -> Generator[None, None, None]:
            yield

    with pytest.raises(ValueError, match="without optimization"):
        Network(Fast("Fast")).run(policy=Policy())
    with pytest.raises(ValueError, match="virtual time"):
        Network(Body(lambda: wait(0))).run(policy=Policy(), real_time=True)
