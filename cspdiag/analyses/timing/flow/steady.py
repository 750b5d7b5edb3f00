"""What a sampled loop is certain to do in each of its samples, for as long as it runs."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping

from cspdiag.analyses.timing.flow.behaviours import Behaviour
from cspdiag.analyses.timing.flow.contention import Contention
from cspdiag.analyses.timing.flow.paths import Job
from cspdiag.base.graphs import reached
from cspdiag.network.ir.network import ChannelKind


def written_in_each_sample(one: Behaviour, contention: Contention, period: int, jobs: Iterable[Job]) -> frozenset[str]:
    """The outputs, by their nets, that every sample of a period after ``jobs`` makes a thread write; none if the thread
    may stop taking these samples.
    """
    if one.may_end or contention.may_be_abandoned(one.number):
        return frozenset()
    sampled = _samples_at(one, period, _waits_after(one, jobs))
    return frozenset.intersection(*(job.path.certain_outputs for job in sampled)) if sampled else frozenset()


def passed_in_each_sample(one: Behaviour, period: int, jobs: Iterable[Job]) -> frozenset[int]:
    """The places at which every sample of a period after ``jobs`` makes a thread pass values on."""
    sampled = _samples_at(one, period, _waits_after(one, jobs))
    return frozenset.intersection(*(job.path.certain_moves for job in sampled)) if sampled else frozenset()


def passed_while_loops_last(one: Behaviour, period: int, jobs: Iterable[Job]) -> dict[range, frozenset[int]]:
    """By the innermost loop around waits, given by its places, those at which every sample of a period makes a thread
    pass values on as long as that loop lasts.
    """
    everything = range(len(one.thread.places))
    around = [range(loop.header, loop.end) for loop in one.thread.loops]
    found: dict[range, frozenset[int]] = {}
    for wait in {job.wait for job in jobs}:
        loop = min((places for places in around if wait in places), key=len, default=everything)
        inside = [other for other in one.waits if other in loop]
        sampled = _samples_at(one, period, inside)
        returning = [job for job in sampled if any(stop in loop for stop in job.path.stops)]
        passed = [_passed_before_return(one, job, loop) for job in returning or sampled]
        found[loop] = frozenset.intersection(*passed) if passed else frozenset()
    return found


def _passed_before_return(one: Behaviour, job: Job, loop: range) -> frozenset[int]:
    """The places at which a job passes values on whenever it returns to a wait in a loop."""
    assert job.offer is not None
    returns = {stop for stop in job.path.stops if stop in loop}
    passed = set()
    for number in job.path.moves:
        place = one.thread.places[number]
        # A fault may come before the value has been passed on; of a process written by hand nothing is known.
        faults = [] if place.is_by_hand else place.successors[1:]
        if not returns & one.search.stops_without(job.offer, [job.offer.target, *faults], number):
            passed.add(number)
    return frozenset(passed)


def may_pause(one: Behaviour, contention: Contention) -> bool:
    """Whether a thread may end while others continue, or be ended by others, and perhaps begin again later."""
    return (one.may_end and not one.thread.is_outermost) or contention.may_be_abandoned(one.number)


def passed_by_partners(
    behaviours: Mapping[int, Behaviour],
    partners: Collection[int],
    begun: Collection[tuple[int, int]],
    kinds: Mapping[str, ChannelKind],
) -> frozenset[tuple[int, int]]:
    """The locations that are certain to be passed if those of ``begun`` are: with them, those at which their
    communications make ``partners`` pass values on.
    """

    def after(location: tuple[int, int]) -> Iterable[tuple[int, int]]:
        move = behaviours[location[0]].thread.places[location[1]].move
        assert move is not None
        for channel, writes in [*((net, True) for net in move.writes), *((net, False) for net in move.reads)]:
            others = [
                k for k in partners if k != location[0] and behaviours[k].jobs_begun_by(channel, writes=not writes)
            ]
            # Of several readers any one takes the value, except from a broadcast.
            if len(others) != 1 and kinds.get(channel) != "broadcast":
                continue
            for number in others:
                one = behaviours[number]
                is_taken = not one.has_samples or all(
                    one.thread.places[wait].offers_end(channel, not writes) for wait in one.waits
                )
                if is_taken:
                    paths = [job.path.certain_moves for job in one.jobs_begun_by(channel, writes=not writes)]
                    yield from ((number, place) for place in sorted(frozenset.intersection(*paths)))

    return frozenset(reached(begun, after))


def _waits_after(one: Behaviour, jobs: Iterable[Job]) -> list[int]:
    after = one.next_waits()
    return list(reached([job.wait for job in jobs], lambda wait: sorted(after.get(wait, ()))))


def _samples_at(one: Behaviour, period: int, waits: Collection[int]) -> list[Job]:
    """The jobs of samples of a period that begin at some waits; none if such a sample may not end one of them."""
    if any(period not in one.thread.places[wait].certain_periods() for wait in waits):
        return []
    return [
        job
        for wait in waits
        for job in one.jobs_after(wait)
        if job.offer is not None and job.offer.kind == "sample" and job.offer.period == period
    ]
