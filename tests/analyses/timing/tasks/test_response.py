"""Response times: textbook figures, and agreement with a simulated processor on random task sets."""

from __future__ import annotations

import random

import pytest

from cspdiag.analyses.timing.task import Task
from cspdiag.analyses.timing.tasks.response import response_time, response_times
from tests.analyses.timing.oracle import worst_response


def preemptive(name: str, period: int, work: int, priority: int, **more: int) -> Task:
    return Task(name, period, work, period, priority, step=1, final=1, **more)


def test_textbook_example_of_preemptive_tasks() -> None:
    """Burns and Wellings, Real-Time Systems and Programming Languages, section on response-time analysis."""
    tasks = [preemptive("a", 7, 3, 1), preemptive("b", 12, 3, 2), preemptive("c", 20, 5, 3)]
    assert [response.worst for response in response_times(tasks)] == [3, 6, 20]


def test_jobs_that_nothing_preempts_in_the_controller_area_network() -> None:
    """Davis and others, Controller Area Network schedulability analysis: refuted, revisited and revised (2007), section
    3.2.

    Message C has its worst response in its second instance. The units are those of the paper multiplied by two hundred.
    """
    tasks = [Task(n, t, 200, t, p) for n, t, p in (("A", 500, 1), ("B", 700, 2), ("C", 700, 3))]
    assert [response.worst for response in response_times(tasks)] == [399, 599, 700]


def test_response_counts_from_the_nominal_release() -> None:
    late = Task("late", 100, 10, 100, 1, jitter=25)
    assert response_time(late, []).worst == 35
    assert response_time(late, []).start == 25


def test_equal_priority_is_served_in_order() -> None:
    one, other = Task("one", 100, 30, 100, 1), Task("other", 100, 20, 100, 1)
    assert [response.worst for response in response_times([one, other])] == [50, 50]


def test_first_come_first_served_never_waits_for_later_jobs() -> None:
    slow, fast = Task("slow", 1000, 50, 1000, 1), Task("fast", 60, 10, 60, 1)
    assert response_time(slow, [fast]).worst == 60
    assert response_time(fast, [slow]).worst == 60


def test_overload_has_no_bound() -> None:
    tasks = [Task("one", 10, 6, 10, 1), Task("other", 10, 5, 10, 2), Task("third", 10, 1, 10, 3)]
    assert [response.worst is None for response in response_times(tasks)] == [False, True, True]


def test_full_load_is_bounded_only_without_blocking() -> None:
    full = [Task("one", 10, 5, 10, 1), Task("other", 10, 5, 10, 2)]
    assert [response.worst for response in response_times(full)] == [9, 10]
    assert response_times([*full, Task("below", 1000, 0, 1000, 3, step=2, final=0)])[1].worst is None


def random_tasks(source: random.Random) -> list[Task]:
    number = source.randint(2, 5)
    shared = source.random() < 0.4
    share = source.uniform(0.3, 1.05) / number
    tasks = []
    for k in range(number):
        period = source.randint(4, 24)
        work = max(1, round(period * share * source.uniform(0.4, 1.6)))
        # Where tasks share a level, jobs have one step each: only then is the analysis of the queue exact, not merely
        # safe.
        step = work if shared else source.choice([work, 1, *(d for d in range(1, work) if work % d == 0)])
        jitter = source.choice([0, 0, source.randint(0, period - 1)])
        priority = source.randint(1, 2) if shared else k
        tasks.append(Task(f"t{k}", period, work, period, priority, jitter=jitter, step=step, final=step))
    return tasks


@pytest.mark.parametrize("seed", range(10))
def test_the_analysis_agrees_with_the_simulated_processor(seed: int) -> None:
    source = random.Random(seed)
    compared = beyond_period = sets = 0
    while sets < 100:
        tasks = random_tasks(source)
        if sum(task.utilization for task in tasks) > 0.97:
            continue
        sets += 1
        for task, response in zip(tasks, response_times(tasks), strict=True):
            others = [other for other in tasks if other is not task]
            assert response.worst is not None
            assert response.worst == worst_response(task, others, 40 * 24), (task, others)
            compared += 1
            beyond_period += response.worst > task.period
    assert compared >= 250
    assert beyond_period >= 10


def test_one_task_and_all_together_agree() -> None:
    source = random.Random(1)
    for _ in range(100):
        tasks = random_tasks(source)
        alone = [response_time(task, [other for other in tasks if other is not task]) for task in tasks]
        assert alone == response_times(tasks)
