"""Sampled loops as the stages on the path of a value."""

from __future__ import annotations

from cspdiag.analyses.timing.flow.contention import Contention
from cspdiag.analyses.timing.flow.steady import may_pause, passed_in_each_sample, passed_while_loops_last
from cspdiag.analyses.timing.flow.value_flow import Stage
from cspdiag.analyses.timing.report.loops import Loop


def stage_of(loop: Loop, response: int, contention: Contention) -> Stage:
    """A loop with its bound in nanoseconds, and where it passes values on."""
    wait = loop.waits[0]
    number = loop.owner.number
    mode = (number, loop.owner.loop_of.get(wait, -1 - wait))
    stage = Stage(loop.period, response, mode, loop.written_in_each_sample)
    stage.jobs.update(loop.jobs_by_thread)
    stage.locations = {
        (thread, place) for thread, jobs in stage.jobs.items() for job in jobs for place in job.path.moves
    }
    stage.while_loops = passed_while_loops_last(loop.owner, loop.period, loop.jobs)
    stage.certain = frozenset((number, place) for places in stage.while_loops.values() for place in places)
    if not may_pause(loop.owner, contention):
        passed = passed_in_each_sample(loop.owner, loop.period, loop.jobs)
        stage.lasting = frozenset((number, place) for place in passed)
    return stage
