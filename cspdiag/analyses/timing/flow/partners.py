"""The partners that a sampled loop waits for within a sample: whether they arrive in time, and what they compute
meanwhile.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from cspdiag.analyses.timing.flow.behaviours import Behaviour
from cspdiag.analyses.timing.flow.contention import Contention
from cspdiag.analyses.timing.flow.deadlock import may_deadlock
from cspdiag.analyses.timing.flow.demands import Demands
from cspdiag.analyses.timing.flow.jobs import cycles
from cspdiag.analyses.timing.flow.paths import ChannelSide, Path
from cspdiag.analyses.timing.refusal import Refusal
from cspdiag.analyses.timing.threads.graph import Offer, Place, Thread
from cspdiag.base import Span
from cspdiag.model.constants.durations import duration


@dataclass
class JointWork:
    """The work of a loop and of the partners that it waits for, for one of its samples: one piece, at the priority of
    the least urgent of them.

    Any of them that is ready runs, so the work is done when none of it and nothing more urgent is left.
    """

    work: int
    step: int
    level: int
    members: set[int]
    included: set[tuple[int, int, int]] = field(default_factory=set)
    """The demands that are part of ``work``: thread, period, origin."""
    waiting_pairs: set[tuple[int, int]] = field(default_factory=set)
    """Pairs of threads that wait for each other, the smaller number first."""


class Partners:
    """Follows the rendezvous of one loop of a thread from sample to sample; with period 0 those of what the thread does
    between its samples.
    """

    def __init__(
        self,
        demands: Demands,
        contention: Contention,
        owner: Behaviour,
        period: int,
        span: Span,
        refusals: list[Refusal],
    ) -> None:
        self.demands = demands
        self.contention = contention
        self.owner = owner
        self.period = period
        self.span = span
        self.refusals = refusals

    def joint_work(self, path: Path) -> JointWork:
        """The work of the loop's own path together with that of all partners that it waits for."""
        found = JointWork(path.work, path.step, self.owner.level, {self.owner.number})
        # A client meets its server at the request; by the answer the server is already counted.
        for (channel, writes), count in sorted(path.meets.items(), key=lambda met: self._is_answer(*met[0])):
            self._wait_for(found, self.owner, (channel, not writes), count, path.fewest_meets.get((channel, writes), 0))
        if len(found.waiting_pairs) >= len(found.members) and len(found.members) > 1:
            self._refuse_all("several partners wait for each other in a circle")
        return found

    def _is_answer(self, channel: str, writes: bool) -> bool:
        """Whether the loop waits there for a partner to which it has sent a request before."""
        return any(
            offer.end == (channel, not writes) and self._requester(one, wait, offer) is self.owner
            for one in self.demands.taking_part(channel, writes=not writes)
            for wait in one.waits
            for offer in one.thread.places[wait].offers
        )

    def _wait_for(self, found: JointWork, who: Behaviour, end: ChannelSide, count: int, fewest: int) -> None:
        """``who`` waits for a communication on a side of a channel, between ``fewest`` and ``count`` times in
        a sample.
        """
        channel, writes = end
        others = [one for one in self.demands.taking_part(channel, writes=writes) if one is not who]
        if not others:
            self._refuse(channel, writes, "no other process is certain to write it before the next sample")
        for partner in others:
            pair = (min(who.number, partner.number), max(who.number, partner.number))
            if pair not in found.waiting_pairs:
                found.waiting_pairs.add(pair)
                self._check_order(who, partner, channel, writes)
            if not self._is_bounded(partner, end, count if count == fewest else 0):
                continue
            if partner.number in found.members:
                # Another channel to a partner that already takes part.
                if partner is not self.owner and not partner.has_samples:
                    found.work += count * max(
                        (job.path.work for job in partner.jobs_begun_by(channel, writes=writes)), default=0
                    )
                continue
            found.members.add(partner.number)
            found.level = max(found.level, partner.level)
            self._count(found, partner, channel, writes, count)

    def _check_order(self, one: Behaviour, other: Behaviour, channel: str, writes: bool) -> None:
        """Two threads that wait for each other have to use their channels in the same order."""
        if may_deadlock(one.thread, other.thread, self._private_channels(one, other)):
            reason = f"it and `{_short(other.thread.path)}` may wait for each other at different channels"
            self._refuse(channel, writes, reason)

    def _private_channels(self, one: Behaviour, other: Behaviour) -> frozenset[str]:
        """The channels that are used by two threads only."""
        both = {one.number, other.number}
        mine = {offer.channel for place in one.thread.places for offer in place.offers if offer.kind == "partner"}
        return frozenset(
            channel
            for channel in mine
            if {part.number for writes in (False, True) for part in self.demands.taking_part(channel, writes=writes)}
            == both
        )

    def _is_bounded(self, partner: Behaviour, end: ChannelSide, times: int) -> bool:
        """Whether the partner reaches the channel as soon as it has done its work, wherever it waits. It is needed
        ``times`` in each sample, 0 where that varies.
        """
        channel, writes = end
        name = f"`{_short(partner.thread.path)}`"
        if not self.contention.runs_whenever(partner.number, self.owner.number):
            return self._refuse(channel, writes, f"{name} need not run meanwhile")
        if partner.may_end:
            return self._refuse(channel, writes, f"{name} may have ended by then")
        if any(job.path.delays for job in partner.jobs):
            return self._refuse(channel, writes, f"{name} may wait for time to pass meanwhile")
        for wait, place in partner.idle_waits():
            if place.offers_end(channel, writes) or self._is_in_step(partner, wait, end, times):
                continue
            return self._refuse(channel, writes, f"{name} may wait for {_awaited(place)} meanwhile")
        if self._is_answered_next(partner, end):
            return True
        after = partner.next_waits()
        elsewhere = {
            wait for wait in partner.waits
            if not partner.thread.places[wait].offers_end(channel, writes) and not partner.thread.places[wait].is_idle
        }  # fmt: skip
        if cycles({wait: after.get(wait, frozenset()) & elsewhere for wait in elsewhere}):
            return self._refuse(channel, writes, f"{name} may continue with others and never return to it")
        return True

    def _is_answered_next(self, server: Behaviour, end: ChannelSide) -> bool:
        """Whether the loop waits for the answer of a server to a request of its own, and the server answers it next."""
        channel, writes = end
        answered = [
            job for job in server.jobs
            for wait in job.path.stops
            for offer in server.thread.places[wait].offers
            if offer.end == end and self._requester(server, wait, offer) is self.owner
        ]  # fmt: skip
        return bool(answered) and all(
            server.thread.places[wait].offers_end(channel, writes) for job in answered for wait in job.path.stops
        )

    def _is_in_step(self, partner: Behaviour, wait: int, end: ChannelSide, times: int) -> bool:
        """Whether the partner follows the same samples, and communicates equally often in each of them."""
        place = partner.thread.places[wait]
        if not self.period or self.period not in place.certain_periods():
            return False
        channel, writes = end
        for job in partner.jobs_after(wait):
            is_sample = job.offer is not None and job.offer.kind == "sample" and job.offer.period == self.period
            wanted = times if is_sample else 0
            if (
                job.path.meets.get((channel, writes), 0) != wanted
                or job.path.fewest_meets.get((channel, writes), 0) != wanted
            ):
                return False
        return times > 0

    def _refuse(self, channel: str, writes: bool, reason: str) -> bool:
        """Refuse to bound a communication; ``writes`` is the side of the partner. Always False."""
        name = channel.rpartition(".")[2]
        offered = f"let the partner offer `{name}` in an alternative wherever it waits"
        advice = f"make `{name}` an `overwrite 1` channel, or {offered}"
        if writes:
            advice = f"read `{name}` in an alternative with the sample, which keeps the last value in a variable"
            advice += f", or {offered}" if self.demands.taking_part(channel, writes=True) else ""
        reason = f"it waits at `{name}` without bound: {reason}"
        self.refusals.append(Refusal(self.owner.thread.path, reason, self.span, advice))
        return False

    def _refuse_all(self, reason: str) -> None:
        advice = "make one of the channels an `overwrite 1` channel"
        self.refusals.append(Refusal(self.owner.thread.path, reason, self.span, advice))

    def _count(self, found: JointWork, partner: Behaviour, channel: str, writes: bool, count: int) -> None:
        """Add the partner's work for ``count`` communications, and for what it may be doing before the first."""
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
            found.included.add((partner.number, self.period, self.owner.number))
        for wait in partner.waits:
            for offer in partner.thread.places[wait].offers:
                if not _offers(partner.thread.places[wait], channel, writes):
                    self._follow(found, partner, wait, offer, count)

    def _count_sampled(self, found: JointWork, partner: Behaviour, channel: str, writes: bool, count: int) -> None:
        in_step = [
            job for job in partner.jobs
            if job.wait in partner.waits
            and job.offer is not None
            and job.offer.kind == "sample"
            and job.offer.period == self.period
        ]  # fmt: skip
        on_channel = partner.jobs_begun_by(channel, writes=writes)
        if on_channel:
            found.work += count * max(job.path.work for job in on_channel)
            found.included.add((partner.number, self.period, self.owner.number))
            if partner.level >= self.owner.level:
                found.work += max((job.path.work for job in partner.jobs if job.wait in partner.waits), default=0)
        else:
            found.work += max((job.path.work for job in in_step), default=0)
            found.included.add((partner.number, self.period, partner.number))
        for job in partner.jobs:
            in_step_job = job in in_step
            for (other, side), times in job.path.meets.items():
                if other != channel:
                    fewest = job.path.fewest_meets.get((other, side), 0) * count if in_step_job else 0
                    self._wait_for(found, partner, (other, not side), times * count, fewest)

    def _follow(self, found: JointWork, partner: Behaviour, wait: int, offer: Offer, count: int) -> None:
        """Follow what the partner itself waits for at another channel before it returns to this one."""
        if offer.kind != "partner" or partner.thread.places[wait].is_idle:
            return
        requester = self._requester(partner, wait, offer)
        if requester is None:
            self._wait_for(found, partner, (offer.channel, not offer.writes), count, 0)
        else:
            # Its work counts separately from the loop; the partner cannot continue until it is served.
            found.level = max(found.level, requester.level)
            if requester is not self.owner:
                self._check_order(requester, partner, offer.channel, not offer.writes)

    def _requester(self, server: Behaviour, wait: int, answer: Offer) -> Behaviour | None:
        """The only thread that can have led the server to this wait, if its next wait is surely for the answer;
        otherwise None.
        """
        clients = self.demands.taking_part(answer.channel, writes=not answer.writes)
        if len(clients) != 1 or clients[0].number == server.number:
            return None
        client = clients[0]
        for job in server.jobs:
            if wait in job.path.stops:
                request = job.offer
                if request is None or request.kind != "partner":
                    return None
                requesters = self.demands.taking_part(request.channel, writes=not request.writes)
                if requesters != clients or not _waits_next_for(client.thread, request, answer):
                    return None
        return client


def _offers(place: Place, channel: str, writes: bool) -> bool:
    """Whether a thread that waits there may take part in a communication on that side of a channel."""
    return any(offer.kind == "partner" and offer.end == (channel, writes) for offer in place.offers)


def _waits_next_for(client: Thread, request: Offer, answer: Offer) -> bool:
    """Whether a thread that has communicated on one channel waits next on another one."""
    places = client.places
    pending = [
        offer.target
        for place in places
        for offer in place.offers
        if offer.kind == "partner" and offer.end == (request.channel, not request.writes)
    ]
    seen: set[int] = set()
    while pending:
        number = pending.pop()
        if number in seen:
            continue
        seen.add(number)
        place = places[number]
        if not place.offers and not place.successors:
            return False
        if place.offers and not (len(place.offers) == 1 and _offers(place, answer.channel, not answer.writes)):
            return False
        # It has arrived there; what comes after that does not count.
        pending += [] if place.offers else place.successors
    return bool(seen)


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
