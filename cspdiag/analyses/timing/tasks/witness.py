"""Schedules in which a loop is late.

A bound that is longer than the period does not show that the loop ever takes so long; such a schedule does.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction

from cspdiag.analyses.timing.flow.behaviours import Behaviour
from cspdiag.analyses.timing.flow.paths import Job
from cspdiag.analyses.timing.result import Witness
from cspdiag.analyses.timing.task import Task, last_in_time
from cspdiag.analyses.timing.tasks.schedule import simulate
from cspdiag.analyses.timing.threads.graph import Thread


def find_witness(
    threads: Sequence[Thread], behaviours: Sequence[Behaviour], order: Mapping[str, int]
) -> Witness | None:
    """The first late sample, if all loops are independent and have one path each, so there is only one schedule with
    all times at their longest.

    None if no sample is late, or if the program is not of this form. ``order`` numbers the inputs by their nets.
    """
    if len(behaviours) != len(threads) or not _start_together(threads) or _may_fail(threads):
        return None
    tasks: list[tuple[Task, Behaviour, Job]] = []
    for one in behaviours:
        jobs = [job for job in one.jobs if job.path.work and (job.wait < 0 or job.wait in one.waits)]
        if not jobs:
            continue
        job = jobs[0]
        if len(jobs) > 1 or job.offer is None or not _is_one_step_loop(one, job) or not _begins_at(one, job.wait):
            return None
        period, work = job.offer.period, job.path.work
        tasks.append((Task(one.thread.path, period, work, last_in_time(period), one.level), one, job))
    found = [_first_late([task for task, _, _ in sorted(tasks, key=key)]) for key in _orders(order)]
    # The order of threads that are ready at the same instant is known, except if one waits for several inputs.
    return found[0] if tasks and None not in found else None


def is_overloaded(threads: Sequence[Thread], behaviours: Sequence[Behaviour]) -> bool:
    """Whether there is certainly more work than time: in one sample on every path, or by all loops that run forever and
    have one path each.
    """
    if _may_fail(threads):
        return False
    load = Fraction()
    for one in behaviours:
        jobs = [job for job in one.jobs if job.path.work and (job.wait < 0 or job.wait in one.waits)]
        for job in jobs:
            if job.offer is not None and job.offer.kind == "sample" and _is_too_much(one, job):
                return True
        if (
            len(jobs) == 1
            and jobs[0].offer is not None
            and _is_one_step_loop(one, jobs[0])
            and _is_surely_reached(one, jobs[0].wait)
        ):
            load += Fraction(jobs[0].path.work, jobs[0].offer.period)
    return load > 1 and _start_together(threads)


def _is_too_much(one: Behaviour, job: Job) -> bool:
    """Whether a sample that is certain to be taken begins work that takes longer than its period on every path."""
    return job.offer is not None and job.path.least_work > job.offer.period and _is_surely_reached(one, job.wait)


def _may_fail(threads: Sequence[Thread]) -> bool:
    """Whether an exception may end the program before a loop is late."""
    return any(place.raises for thread in threads for place in thread.places)


def _begins_at(one: Behaviour, wait: int) -> bool:
    """Whether the first wait of a thread is this one in any case."""
    return all(job.path.is_unique and job.path.stops == {wait} for job in one.jobs if job.offer is None)


def _is_surely_reached(one: Behaviour, goal: int) -> bool:
    """Whether some environment leads a thread to a wait for a sample, whatever conditions, partners and delays do."""
    if any(offer.kind not in ("sample", "event") for offer in one.thread.places[goal].offers):
        return False
    jobs = [job for job in one.jobs if job.offer is None]
    seen: set[int] = set()
    while jobs:
        job = jobs.pop()
        if not job.path.is_unique or len(job.path.stops) != 1:
            continue
        (wait,) = job.path.stops
        if wait == goal:
            return True
        if wait not in seen:
            seen.add(wait)
            jobs += _chosen_outside(one, wait)
    return False


def _chosen_outside(one: Behaviour, wait: int) -> list[Job]:
    """The jobs that the environment can begin after a wait."""
    kinds = {offer.kind for offer in one.thread.places[wait].offers}
    if kinds <= {"event", "sample"} or kinds == {"delay"} or kinds == {"event", "delay"}:
        jobs = (job for job in one.jobs_after(wait) if job.offer is not None)
        return [job for job in jobs if job.offer is not None and job.offer.is_certain]
    return []


def _start_together(threads: Sequence[Thread]) -> bool:
    """Whether all threads run from the beginning and forever."""
    root, *others = threads
    return len(root.forks) == (1 if others else 0) and not any(thread.forks for thread in others)


def _is_one_step_loop(one: Behaviour, job: Job) -> bool:
    """Whether a job is one step that a sample begins, followed by the wait for the next sample and nothing else."""
    path = job.path
    is_alone = len(one.thread.places[job.wait].offers) == 1 and path.is_unique and path.stops == {job.wait}
    is_sample = job.offer is not None and job.offer.kind == "sample"
    return is_alone and is_sample and not (path.switches or path.delays or path.meets or path.sends)


def _orders(order: Mapping[str, int]) -> Iterator[Callable[[tuple[Task, Behaviour, Job]], int]]:
    def by_wait(part: tuple[Task, Behaviour, Job]) -> int:
        assert part[2].offer is not None
        return order[part[2].offer.channel]

    def by_inputs(part: tuple[Task, Behaviour, Job]) -> int:
        offers = (offer for place in part[1].thread.places for offer in place.offers if offer.kind == "sample")
        return min(order[offer.channel] for offer in offers)

    yield by_wait
    yield by_inputs


def _first_late(tasks: Sequence[Task]) -> Witness | None:
    """The first late sample in a run of the program; later ones do not count, because a sample may have been missed."""
    begun: dict[tuple[int, int], int] = {}
    late: list[tuple[int, Witness]] = []
    for part in simulate(tasks, hyperperiods=2, first=1).slices:
        begun.setdefault((part.task, part.release), part.start)
        due = part.release + tasks[part.task].deadline
        if part.is_last and part.end > due:
            is_missed = begun[part.task, part.release] > due
            task = tasks[part.task]
            next_release = part.release + task.period
            late.append((due, Witness(task.name, part.release, next_release, None if is_missed else part.end)))
    return min(late, key=lambda found: found[0])[1] if late else None
