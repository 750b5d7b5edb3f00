"""Partners that a sampled loop waits for within a sample: whether they come in time, and what they compute meanwhile."""

from __future__ import annotations

from dataclasses import dataclass, field

from cspdiag.analyses.timing.demands import Behaviour, Demands
from cspdiag.analyses.timing.flow import Offer, Place
from cspdiag.analyses.timing.jobs import Path
from cspdiag.analyses.timing.result import Refusal
from cspdiag.diagnostics import Span
from cspdiag.model.durations import duration


@dataclass
class Together:
    """A loop with the partners it waits for: their work for one of its samples is one piece, at the level of the least urgent of them.

    Whoever of them is ready runs, so that the work is done when nothing of it and nothing more urgent is left to do.
    """

    work: int
    step: int
    level: int
    members: set[int]
    replaced: set[tuple[int, int, int]] = field(default_factory=set)
    """Demands that are part of ``work``: thread, period, origin."""


class Partners:
    """Follows the rendezvous of one loop of a thread, whose samples have a period."""

    def __init__(self, demands: Demands, owner: Behaviour, period: int, span: Span, refusals: list[Refusal]) -> None:
        self.demands = demands
        self.owner = owner
        self.period = period
        self.span = span
        self.refusals = refusals

    def together(self, path: Path) -> Together:
        """The loop's own path with all that it waits for."""
        found = Together(path.work, path.step, self.owner.level, {self.owner.number})
        for (channel, writes), count in path.meets.items():
            self._add(found, channel, not writes, count)
        return found

    def _add(self, found: Together, channel: str, writes: bool, count: int) -> None:
        others = self.demands.taking_part(channel, writes=writes)
        partners = [one for one in others if one.number not in found.members]
        if not others:
            self._refuse(channel, "nothing that has a bound takes part in it")
        for partner in partners:
            if self._is_bounded(partner, channel, writes):
                found.members.add(partner.number)
                found.level = max(found.level, partner.level)
                self._count(found, partner, channel, writes, count)

    def _is_bounded(self, partner: Behaviour, channel: str, writes: bool) -> bool:
        """Whether the partner comes to the channel as soon as it has done its work, wherever it waits."""
        for wait, place in partner.idle_waits():
            if any(
                offer.kind == "partner" and (offer.channel, offer.writes) == (channel, writes) for offer in place.offers
            ):
                continue
            if self.period in _periods(place) or (wait not in partner.loop_of and not _leads_on(partner, wait)):
                continue
            self._refuse(channel, f"`{_short(partner.thread.path)}` may wait for {_awaited(place)} meanwhile")
            return False
        return True

    def _refuse(self, channel: str, reason: str) -> None:
        name = channel.rpartition(".")[2]
        self.refusals.append(Refusal(
            self.owner.thread.path, f"it waits at `{name}` without bound: {reason}", self.span,
            f"make `{name}` an `overwrite 1` channel, or let the partner offer it in an alternative wherever it waits",
        ))  # fmt: skip

    def _count(self, found: Together, partner: Behaviour, channel: str, writes: bool, count: int) -> None:
        """The partner's work for ``count`` communications, and for what it is doing when the first is wanted."""
        inside = [job for job in partner.jobs if job.wait in partner.waits]
        found.step = max(found.step, max((job.path.step for job in inside), default=0))
        if partner.has_samples:
            self._count_sampled(found, partner, channel, writes, count)
        else:
            by_wait: dict[int, int] = {}
            for job in inside:
                if job.offer is not None and job.offer.kind == "partner":
                    by_wait[job.wait] = max(by_wait.get(job.wait, 0), job.path.work)
            found.work += count * sum(by_wait.values())
            others = self.demands.activators(channel, writes=not writes) - found.members
            found.work += max(by_wait.values(), default=0) if others else 0
            found.replaced.add((partner.number, self.period, self.owner.number))
        for wait in partner.waits:
            for offer in partner.thread.places[wait].offers:
                self._follow(found, partner, wait, offer, channel, count)

    def _count_sampled(self, found: Together, partner: Behaviour, channel: str, writes: bool, count: int) -> None:
        in_step = [
            job for job in partner.jobs
            if job.wait in partner.waits and job.offer is not None and job.offer.kind == "sample" and job.offer.period == self.period
        ]  # fmt: skip
        on_channel = partner.jobs_on(channel, writes=writes)
        if on_channel:
            found.work += count * max(job.path.work for job in on_channel)
            found.replaced.add((partner.number, self.period, self.owner.number))
            if partner.level >= self.owner.level:
                found.work += max((job.path.work for job in partner.jobs if job.wait in partner.waits), default=0)
        else:
            found.work += max((job.path.work for job in in_step), default=0)
            found.replaced.add((partner.number, self.period, partner.number))
        for job in partner.jobs:
            for (other, side), times in job.path.meets.items():
                if other != channel:
                    self._add(found, other, not side, times * count)

    def _follow(self, found: Together, partner: Behaviour, wait: int, offer: Offer, channel: str, count: int) -> None:
        """What the partner itself waits for at another channel, before it comes back to this one."""
        if offer.kind == "partner" and offer.channel != channel and not partner.thread.places[wait].is_idle:
            self._add(found, offer.channel, not offer.writes, count)


def _periods(place: Place) -> set[int]:
    return {offer.period for offer in place.offers if offer.kind == "sample"}


def _leads_on(partner: Behaviour, wait: int) -> bool:
    return any(job.path.stops for job in partner.at(wait))


def _short(path: str) -> str:
    return path.partition(".")[2] or path


def _awaited(place: Place) -> str:
    for offer in place.offers:
        if offer.kind == "sample":
            return f"a sample of {duration(offer.period)}"
        if offer.kind == "event":
            return f"the event `{offer.channel.rpartition('.')[2]}`"
        if offer.kind == "delay":
            return "time to pass"
    return "parallel parts to end"
