"""The sampled loops of the threads of a program, as they are before their response times are known."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from cspdiag.analyses.timing.flow.behaviours import Behaviour
from cspdiag.analyses.timing.flow.contention import Contention
from cspdiag.analyses.timing.flow.demands import Demands
from cspdiag.analyses.timing.flow.partners import JointWork, Partners
from cspdiag.analyses.timing.flow.paths import Job
from cspdiag.analyses.timing.flow.steady import written_in_each_sample
from cspdiag.analyses.timing.refusal import Refusal
from cspdiag.base import Span


@dataclass
class Loop:
    """A sampled loop of a thread before it is analysed. Times are in nanoseconds."""

    name: str
    owner: Behaviour
    waits: tuple[int, ...]
    period: int
    span: Span
    jobs_by_thread: dict[int, list[Job]]
    """Its own jobs first, and those of the partners that follow no samples of their own: what they write belongs to the
    loop.
    """
    joint_work: JointWork
    delays: int
    delay_time: int
    has_one_step: bool
    written_in_each_sample: frozenset[str]
    """The outputs that it writes in each of its samples."""

    @property
    def jobs(self) -> list[Job]:
        """The jobs of its own thread."""
        return self.jobs_by_thread[self.owner.number]


def loops_of(
    one: Behaviour,
    behaviours: Mapping[int, Behaviour],
    demands: Demands,
    contention: Contention,
    refusals: list[Refusal],
) -> Iterator[Loop]:
    """The sampled loops of a thread: waits for samples that it reaches again, or after which it still follows their
    inputs. ``behaviours`` are those of all threads, by number.
    """
    grouped: dict[tuple[str, int], list[Job]] = {}
    for job in one.jobs:
        if job.offer is None or job.offer.kind != "sample":
            continue
        if job.wait in one.loop_of or job.offer.period in job.path.still_followed:
            of_wait = [
                other for other in one.jobs_after(job.wait)
                if other.offer is not None and other.offer.kind == "sample" and other.offer.period == job.offer.period
            ]  # fmt: skip
            heaviest = max(of_wait, key=lambda other: other.path.heaviest[0]).path.heaviest
            name = heaviest[1] or one.thread.places[job.wait].path
            grouped.setdefault((name, job.offer.period), []).append(job)
    for (name, period), jobs in grouped.items():
        span = one.thread.places[jobs[0].wait].span
        partners = Partners(demands, contention, one, period, span, refusals)
        pieces = [partners.joint_work(job.path) for job in jobs]
        joint_work = max(pieces, key=lambda piece: piece.work)
        joint_work.step = max(piece.step for piece in pieces)
        joint_work.level = max(piece.level for piece in pieces)
        for piece in pieces:
            joint_work.members |= piece.members
            joint_work.included |= piece.included
        alone = len(joint_work.members) == 1
        by_thread = {one.number: jobs}
        for number in joint_work.members:
            partner = behaviours[number]
            if not partner.has_samples:
                by_thread[number] = [job for job in partner.jobs if job.wait in partner.waits]
        yield Loop(
            name, one, tuple(dict.fromkeys(job.wait for job in jobs)), period, span, by_thread, joint_work,
            max(job.path.delays for job in jobs),
            max(job.path.delay_time for job in jobs),
            alone and all(not job.path.switches for job in jobs),
            written_in_each_sample(one, contention, period, jobs),
        )  # fmt: skip


def work_of_partners(
    one: Behaviour, demands: Demands, contention: Contention, refusals: list[Refusal]
) -> tuple[int, int]:
    """How much partners compute at most for what a thread does between its samples, and the level of the least urgent
    of them.
    """
    longest, level = 0, one.level
    for job in one.jobs:
        if job.follows_samples and job.path.meets and job.offer is not None and job.offer.kind != "sample":
            partners = Partners(demands, contention, one, 0, one.thread.places[job.wait].span, refusals)
            joint_work = partners.joint_work(job.path)
            longest, level = max(longest, joint_work.work - job.path.work), max(level, joint_work.level)
    return longest, level
