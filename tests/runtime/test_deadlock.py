"""The report of a deadlock."""

from __future__ import annotations

import pytest

from cspdiag.runtime import (
    Alternative,
    Broadcast,
    Channel,
    EventInput,
    In,
    Input,
    Network,
    Out,
    Output,
    Process,
    parallel,
    read_all,
    stop,
)
from cspdiag.runtime.deadlock import partners, tasks
from cspdiag.runtime.deadlock.tasks import Ends, NamesIn
from cspdiag.runtime.kernel.scheduler import Task
from tests.runtime.support import run


class Reader(Process):
    def __init__(self, name: str, source: In[int], sink: Out[int]) -> None:
        super().__init__(name, source=f"ring.csp:{len(name)}")
        self.source_end = source
        self.sink = sink

    async def run(self) -> None:
        await self.sink.write(await self.source_end.read())  # ring.csp:12


class Top(Process):
    def __init__(self, *parts: Process) -> None:
        super().__init__("Top", source="ring.csp:1")
        self.parts = parts

    async def run(self) -> None:
        await parallel(*self.parts)


def test_the_cycle_names_processes_channels_and_lines() -> None:
    a, b, c = (Channel[int](f"Top.{name}") for name in "abc")
    outcome = Network(Top(Reader("Top.p", a, b), Reader("Top.q", b, c), Reader("Top.r", c, a))).run()
    assert outcome.ended == "deadlock"
    report = outcome.deadlock
    assert report is not None
    assert report.text.splitlines() == [
        "deadlock at 0 s: 3 processes wait for each other",
        "  Top.p waits to read Top.a (ring.csp:12), for Top.r",
        "  Top.r waits to read Top.c (ring.csp:12), for Top.q",
        "  Top.q waits to read Top.b (ring.csp:12), for Top.p",
    ]
    assert [process.path for process in report.cycle] == ["Top.p", "Top.r", "Top.q"]
    assert report.cycle[0].channels == ("Top.a",)
    assert report.cycle[0].source == "ring.csp:5"


def test_what_is_around_many_processes_is_looked_through_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """It knows the ends of all of them."""
    taken: list[object] = []

    def ends_used_by(task: Task, names_in: NamesIn | None = None) -> Ends:
        taken.append(task)
        return tasks.ends_used_by(task, names_in)

    monkeypatch.setattr(partners, "ends_used_by", ends_used_by)
    channels = [Channel[int](f"Top.c[{number}]") for number in range(30)]
    around = [channels[-1], *channels]
    outcome = Network(Top(*(Reader(f"Top.p[{n}]", around[n], around[n + 1]) for n in range(30)))).run()
    assert outcome.deadlock is not None
    assert len(outcome.deadlock.cycle) == 30
    assert len(taken) == 31


def test_processes_that_only_depend_on_the_cycle_are_listed_apart() -> None:
    a, b, c, d = (Channel[int](f"Top.{name}") for name in "abcd")
    outcome = Network(Top(Reader("Top.last", c, d), Reader("Top.p", a, b), Reader("Top.q", b, a))).run()
    assert outcome.deadlock is not None
    assert {process.path for process in outcome.deadlock.cycle} == {"Top.p", "Top.q"}
    assert "besides:\n  Top.last waits to read Top.c" in outcome.deadlock.text


def test_waiting_for_what_no_process_does_any_more() -> None:
    a, b = Channel[int]("Top.a"), Channel[int]("Top.b")
    outcome = Network(Top(Reader("Top.p", a, b))).run()
    assert outcome.deadlock is not None
    assert outcome.deadlock.cycle == ()
    assert outcome.deadlock.text.splitlines() == [
        "deadlock at 0 s: nothing that a process waits for can happen any more",
        "  Top.p waits to read Top.a (ring.csp:12); no other process that still runs writes to it",
    ]


def test_alternatives_and_submodels_name_all_they_wait_for() -> None:
    a, b, c = Channel[int]("a"), Broadcast[int]("b"), Channel[int]("c")
    end = b.reader()

    async def top() -> None:
        await parallel(Alternative(Input(a), Output(c, 1)).select(), read_all(end, Channel("d")), stop())

    report = run(top).deadlock
    assert report is not None
    assert [process.waits for process in report.waiting] == [
        "to read a or to write c",
        "to read b or to read d",
        "forever, at stop",
    ]


def test_an_event_without_a_driver_can_never_occur() -> None:
    port = EventInput[int]("Top.button")

    async def top() -> None:
        await port.reader().read()

    report = run(top, [port]).deadlock
    assert report is not None
    assert "waits to read Top.button" in report.text


def test_a_broadcast_is_recognized_from_both_sides() -> None:
    there, back = Broadcast[int]("Top.there"), Channel[int]("Top.back")
    outcome = Network(Top(Reader("Top.p", there.reader(), back), Reader("Top.q", back, there))).run()
    assert outcome.deadlock is not None
    assert len(outcome.deadlock.cycle) == 2


def test_the_writer_of_a_broadcast_waits_to_write() -> None:
    broadcast = Broadcast[int]("b")
    broadcast.reader()

    async def top() -> None:
        await parallel(broadcast.write(1), stop())

    report = run(top).deadlock
    assert report is not None
    assert [process.waits for process in report.waiting] == ["to write b", "forever, at stop"]
