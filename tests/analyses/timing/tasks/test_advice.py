"""Orders of priorities, earliest deadline first, and the simulated hyperperiod."""

from __future__ import annotations

import itertools
import random

import pytest

from cspdiag.analyses.timing.report.render_text import table
from cspdiag.analyses.timing.task import Task
from cspdiag.analyses.timing.tasks.assignment import feasible_order
from cspdiag.analyses.timing.tasks.edf import demand_bound, meets_deadlines
from cspdiag.analyses.timing.tasks.response import response_times
from cspdiag.analyses.timing.tasks.schedule import simulate
from cspdiag.base.record import replaced
from tests.analyses.timing.programs import law, loops_of, report_of


def random_set(source: random.Random, *, number: int, load: float) -> list[Task]:
    tasks = []
    for k in range(number):
        period = source.choice([4, 5, 6, 8, 10, 12, 20])
        work = max(1, round(period * load / number * source.uniform(0.5, 1.5)))
        tasks.append(Task(f"t{k}", period, work, source.randint(max(work, period // 2), period), k))
    return tasks


def is_met(tasks: list[Task], order: tuple[int, ...]) -> bool:
    ranked = [replaced(tasks[k], priority=rank) for rank, k in enumerate(order)]
    return all(
        response.worst is not None and response.worst <= task.deadline
        for task, response in zip(ranked, response_times(ranked), strict=True)
    )


def test_an_order_is_found_exactly_where_there_is_one() -> None:
    source = random.Random(7)
    found = 0
    for _ in range(200):
        tasks = random_set(source, number=4, load=0.8)
        there_is = any(is_met(tasks, order) for order in itertools.permutations(range(4)))
        order = feasible_order(tasks)
        assert (order is not None) == there_is
        if order is not None:
            assert is_met(tasks, tuple(order))
            found += 1
    assert 40 < found < 190


def edf_is_late(tasks: list[Task], horizon: int, blocker: Task | None) -> bool:
    """Earliest deadline first without preemption, simulated; ``blocker`` has begun one unit before all others
    arrive.
    """
    jobs = [
        (k * task.period, k * task.period + task.deadline, task.work)
        for task in tasks
        if task is not blocker
        for k in range(horizon // task.period)
    ]
    jobs.sort()
    now = blocker.work - 1 if blocker is not None else 0
    ready: list[tuple[int, int, int]] = []
    while jobs or ready:
        while jobs and jobs[0][0] <= now:
            release, deadline, work = jobs.pop(0)
            ready.append((deadline, release, work))
        if not ready:
            now = jobs[0][0]
            continue
        ready.sort()
        deadline, _, work = ready.pop(0)
        now += work
        if now > deadline:
            return True
    return False


def test_what_earliest_deadline_first_meets_is_never_seen_late() -> None:
    source = random.Random(11)
    met = refused = 0
    for _ in range(200):
        tasks = random_set(source, number=3, load=0.85)
        late = any(edf_is_late(tasks, 240, blocker) for blocker in (None, *tasks))
        if meets_deadlines(tasks):
            assert not late, tasks
            met += 1
        else:
            refused += 1
    assert met > 30
    assert refused > 30


def test_demand_of_an_interval() -> None:
    tasks = [Task("a", 10, 3, 8, 0), Task("b", 20, 5, 20, 1)]
    assert [demand_bound(tasks, interval) for interval in (7, 8, 18, 20, 28, 40)] == [0, 3, 6, 11, 14, 22]


def test_the_hyperperiod_shows_what_the_analysis_bounds() -> None:
    source = random.Random(3)
    for _ in range(100):
        tasks = random_set(source, number=4, load=0.7)
        schedule = simulate(tasks)
        assert schedule.is_whole
        for k, response in enumerate(response_times(tasks)):
            assert response.worst is None or schedule.longest_response(k) <= response.worst
        for one, other in itertools.pairwise(schedule.slices):
            assert one.end <= other.start


def test_more_urgent_jobs_come_between_steps() -> None:
    schedule = simulate([Task("fast", 4, 1, 4, 0), Task("slow", 8, 4, 8, 1, step=2, final=2)])
    assert [(part.task, part.start, part.end) for part in schedule.slices] == [
        (0, 0, 1),
        (1, 1, 3),
        (1, 3, 5),
        (0, 5, 6),
    ]


def test_a_hyperperiod_without_end_is_cut_short() -> None:
    schedule = simulate([Task("a", 999_983, 10, 999_983, 0), Task("b", 1_000_003, 10, 1_000_003, 1)])
    assert not schedule.is_whole
    assert schedule.length < schedule.hyperperiod
    assert len(schedule.slices) <= 20_002


def test_nothing_is_advised_that_was_not_decided() -> None:
    """Every sample of these loops is in time in this very order, whatever the laws take, although the bounds for all
    phases are longer.
    """
    text = loops_of(("a", "4 ms", "1 ms"), ("b", "6 ms", "2500 us"), ("c", "12 ms", "3 ms"), order="||>")
    report = report_of(text)
    assert report.advice is None
    assert report.is_edf_feasible is None
    reported = table(report)
    assert "no order of priorities is known that meets every deadline" in reported
    assert "earliest deadline first" not in reported
    assert "no order of priorities meets" not in reported


def test_an_order_is_advised_for_the_branches_of_one_parallel_only() -> None:
    """The order is reported in the form in which `||>` would join the loops."""
    loops = (("slow", "10 ms", "700 us"), ("fast", "1 ms", "200 us"), ("mid", "4 ms", "600 us"))
    text = loops_of(*loops, order="||>")
    assert report_of(text).advice == ("fast", "mid", "slow")
    nested = text.replace("mu slow ||> mu fast ||> mu mid", "mu slow ||> (mu fast ||> mu mid)")
    assert nested != text
    assert report_of(nested).advice is None


BESIDE = (
    law("Law", "600 us") + law("Other", "700 us") +
    """
    process Later {
      in x  : double
      in go : double
      communication {
        second : Other
        var v : double = 0
        x -> second.x
        second.y -> _
      }
      composition { <before> mu second }
    }
    process Main {
      in  x, z : double @ 1 ms
      in  go   : double
      communication {
        first : Law
        later : Later
        x -> first.x
        z -> later.x
        go -> later.go
        first.y -> _
      }
      composition { mu first || later }
    }
    """
)  # fmt: skip


@pytest.mark.parametrize(
    ("before", "answer"),
    [("go ? v ;", False), ("wait 3 ms ;", False), ("if v > 5 then", None), ("while v < 5 do", None)],
)
def test_only_loops_that_surely_run_are_too_much_for_certain(before: str, answer: bool | None) -> None:
    report = report_of(BESIDE.replace("<before>", before))
    assert report.utilization > 1
    assert report.is_schedulable is answer
    assert ("more work than time: no order" in table(report)) == (answer is False)
    assert report.is_edf_feasible is answer
