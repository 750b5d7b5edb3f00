"""Outputs that a sampled loop is certain to write in each of its samples, for as long as the program runs."""

from __future__ import annotations

from collections.abc import Iterable

from cspdiag.analyses.timing.flow.behaviours import Behaviour
from cspdiag.analyses.timing.flow.contention import Contention
from cspdiag.analyses.timing.flow.paths import Job
from cspdiag.base.graphs import reached


def written_in_each_sample(one: Behaviour, contention: Contention, period: int, jobs: Iterable[Job]) -> frozenset[str]:
    """The outputs, by their nets, that every sample of a period after ``jobs`` makes a thread write; none if the thread
    may stop taking these samples.
    """
    if one.may_end or contention.may_be_abandoned(one.number):
        return frozenset()
    after = one.next_waits()
    waits = list(reached([job.wait for job in jobs], lambda wait: sorted(after.get(wait, ()))))
    if any(period not in one.thread.places[wait].certain_periods() for wait in waits):
        return frozenset()
    sampled = [
        job.path.certain_outputs
        for wait in waits
        for job in one.jobs_after(wait)
        if job.offer is not None and job.offer.kind == "sample" and job.offer.period == period
    ]
    return frozenset.intersection(*sampled) if sampled else frozenset()
