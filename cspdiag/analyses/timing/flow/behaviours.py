"""How each thread gets from wait to wait, and where it may miss samples."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from cspdiag.analyses.timing.flow.jobs import Gap, JobSearch, UnboundedError, cycles
from cspdiag.analyses.timing.flow.paths import Job
from cspdiag.analyses.timing.refusal import Refusal
from cspdiag.analyses.timing.threads.graph import Place, Thread
from cspdiag.model.constants.durations import duration


@dataclass(slots=True)
class Behaviour:
    """A thread with its jobs; ``waits`` are those at which it may arrive, ``loop_of`` gives the cycle that each is part
    of.
    """

    number: int
    thread: Thread
    level: int
    jobs: list[Job]
    waits: frozenset[int]
    loop_of: dict[int, int]
    has_samples: bool
    search: JobSearch

    @property
    def may_end(self) -> bool:
        """Whether it may end, or wait forever, while others continue."""
        return self.search.ends

    def jobs_after(self, wait: int) -> Iterator[Job]:
        """The jobs that begin when a wait ends."""
        return (job for job in self.jobs if job.wait == wait)

    def idle_waits(self) -> Iterator[tuple[int, Place]]:
        """The waits at which time may pass whatever others do."""
        return ((wait, self.thread.places[wait]) for wait in sorted(self.waits) if self.thread.places[wait].is_idle)

    def jobs_begun_by(self, channel: str, *, writes: bool) -> list[Job]:
        """The jobs that a communication begins."""
        return [
            job
            for job in self.jobs
            if job.offer is not None and job.offer.kind == "partner" and job.offer.end == (channel, writes)
        ]

    def next_waits(self) -> dict[int, frozenset[int]]:
        """For each wait those that may come next."""
        after: dict[int, frozenset[int]] = {}
        for job in self.jobs:
            after[job.wait] = after.get(job.wait, frozenset()) | job.path.stops
        return after

    def has_no_inner_waits(self) -> bool:
        """Whether no job waits for anything before its end."""
        return not any(job.path.meets or job.path.delays for job in self.jobs)

    def is_prompt(self, channel: str, writes: bool) -> bool:
        """Whether it offers a communication, or waits for an event, wherever it waits."""
        return self.has_no_inner_waits() and all(
            any(offer.is_certain and offer.channel == channel and offer.writes == writes for offer in place.offers)
            for place in (self.thread.places[wait] for wait in self.waits)
        )


def behaviour(number: int, thread: Thread, level: int, refusals: list[Refusal]) -> Behaviour | None:
    """How a thread gets from wait to wait; None if its work has no bound, which is reported."""
    samples = thread.has_samples()
    try:
        search = JobSearch(thread, meets=samples)
        jobs = search.find()
    except UnboundedError as problem:
        refusals.append(
            Refusal(thread.path, problem.reason, problem.span, "let each round of the loop wait for a sample")
        )
        return None
    refusals += dict.fromkeys(_refusal(thread, gap) for gap in search.gaps)
    waits = frozenset(wait for job in jobs for wait in job.path.stops)
    one = Behaviour(number, thread, level, jobs, waits, {}, samples, search)
    after = one.next_waits()
    loops = cycles({wait: after.get(wait, frozenset()) for wait in waits})
    one.loop_of = {wait: k for k, loop in enumerate(loops) for wait in loop}
    return one


def _refusal(thread: Thread, gap: Gap) -> Refusal:
    """Why samples may be missed at a place."""
    place = thread.places[gap.place]
    net, period = gap.followed[0]
    name = net.rpartition(".")[2]
    if gap.untaken:
        return Refusal(
            place.path,
            f"the sample of `{name}` may not have been taken when this waits for the next samples, {duration(period)} "
            "later: it would be overwritten",
            place.span,
            "take the samples of all inputs of a period in every round, or give each loop a process of its own",
        )
    if place.is_end:
        what = "stops here" if place.halts else "ends here"
        return Refusal(
            place.path, f"what reads `{name}` {what}, but its samples arrive until the process has ended", place.span,
            f"read `{name}` in a process of its own, which ends with its loop",
        )  # fmt: skip
    others = place.certain_periods()
    if others:
        shortest, longest = sorted((period, max(others)))
        return Refusal(
            place.path, (
                f"one loop waits for samples of {duration(shortest)} and of {duration(longest)}, so it misses the "
                "faster ones"
            ),
            place.span, "read the slower input in an alternative with the faster one, or in a parallel process",
        )  # fmt: skip
    if place.periods():
        return Refusal(
            place.path, f"it may wait where a sample of `{name}` is taken only under a condition", place.span,
            f"let the alternative take samples of `{name}` without a condition",
        )  # fmt: skip
    delay = place.longest_delay()
    if delay is not None:
        return Refusal(
            place.path,
            f"between two samples of `{name}`, which come every {duration(period)}, it waits {duration(delay)}",
            place.span,
            "wait in a parallel process, or by `after` in an alternative with the sample",
        )  # fmt: skip
    return Refusal(
        place.path, f"between its samples it waits for {_awaited(place)}, without bound", place.span,
        "wait for it in an alternative together with the sample, or in a parallel process",
    )  # fmt: skip


def _awaited(place: Place) -> str:
    for offer in place.offers:
        if offer.kind == "event":
            return f"the event `{offer.channel.rpartition('.')[2]}`"
        if offer.kind == "join":
            return "parallel parts that loop"
        if offer.kind == "delay":
            return "time to pass"
    return "something else"
