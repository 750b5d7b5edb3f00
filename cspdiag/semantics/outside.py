"""The ports of the outermost process: inputs from the environment, and outputs to it."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

from cspdiag.model.sampling import Sampling
from cspdiag.semantics.media import EndKey, Medium, NonBlocking, Offer, World
from cspdiag.semantics.values import FaultError, RaisedError


class MissedSampleError(RaisedError):
    """A sample was overwritten before it was taken: exception ``Timeout``. «Time»"""


class EventOutput(NonBlocking):
    """An output that hands each value over to the environment when it is written: an event port, or an ``immediate``
    one.

    «Time»
    """

    communicates = True

    def write(self, value: Any) -> None:
        """Hand the value over."""
        _require_finite(value)
        self.world.hand_over(self.name, value)


class SampledOutput(NonBlocking):
    """An output whose last value is latched, and handed over at the next tick. «Time»"""

    communicates = True

    def __init__(self, world: World, name: str, sampling: Sampling) -> None:
        super().__init__(world, name)
        self.sampling = sampling
        self.latched: list[Any] = []

    def write(self, value: Any) -> None:
        """Latch a value; the last one written in a period wins."""
        _require_finite(value)
        self.latched = [value]

    def tick(self) -> None:
        """Hand over the value that was written since the last tick."""
        for value in self.latched:
            self.world.hand_over(self.name, value)
        self.latched = []


def _require_finite(value: Any) -> None:
    if isinstance(value, tuple):
        for part in value:
            _require_finite(part)
    elif isinstance(value, float) and not math.isfinite(value):
        raise FaultError(f"{value} for an output of the outermost process")


class ExternalInput(Medium):
    """An input: a waiting reader is woken when a value is there, and takes it when it runs. «Parties, channels and
    guards»
    """

    outside = True

    present: Any = None
    """The present value of the environment's output."""

    def arrive(self, offer: Offer) -> None:
        """Take the value that is there, or wait."""
        self.offers.append(offer)
        self.retry(offer)

    def retry(self, offer: Offer) -> None:
        """Take the value that is there now, if there is one; that is the communication. «Traces»"""
        if self.ready(offer):
            offer.value = self.take(offer.end)
            self.world.communicate(self.name, offer.value, reader=offer.end[0])
            self.complete(offer)

    def choose(self, offer: Offer) -> None:
        """Take the value; a ready guard leaves it to the read that follows."""
        if offer.only_ready:
            offer.done = True
        else:
            self.retry(offer)

    def take(self, end: EndKey) -> Any:
        """The value, which is then no longer there for this end."""
        raise NotImplementedError


class EventInput(ExternalInput):
    """An event input: keeps the latest value until it is read; with ``broadcast`` each end has its own. «Time»"""

    def __init__(self, world: World, name: str, broadcast: bool) -> None:
        super().__init__(world, name)
        self.broadcast = broadcast
        self.latches: dict[EndKey | None, Any] = {}

    def offered(self, value: Any) -> None:
        """Take the value of the environment's output at an instant of the grid; it is an event if it has changed."""
        if value != self.present:
            self.present = value
            for latch in self.ends if self.broadcast else [None]:
                self.latches[latch] = value
                self.world.notice()

    def _key(self, end: EndKey) -> EndKey | None:
        return end if self.broadcast else None

    def ready(self, offer: Offer) -> bool:
        """Whether there is an event that has not been read."""
        return self._key(offer.end) in self.latches

    def wakes(self, offer: Offer) -> bool:
        """Whether there is an event for this reader; one that all share wakes the reader that has waited longest.
        «Parties, channels and guards»
        """
        waiting = [o for o in self.offers if o.guard is None and self._key(o.end) == self._key(offer.end)]
        return self.ready(offer) and waiting[0] is offer

    def take(self, end: EndKey) -> Any:
        """The value of the event, which is then over."""
        return self.latches.pop(self._key(end))


@dataclasses.dataclass
class Session:
    """What is recorded for a reading end of a sampled input. «Time»"""

    since: int
    available: bool
    missed: bool = False


class SampledInput(ExternalInput):
    """An input that takes a sample at its ticks. «Time»"""

    def __init__(self, world: World, name: str, sampling: Sampling) -> None:
        super().__init__(world, name)
        self.sampling = sampling
        self.sessions: dict[EndKey, Session] = {}
        self.missed = 0
        """The number of samples that were overwritten before an end had taken them."""

    def sampled(self, value: Any) -> None:
        """Take a new sample; for each end that has not taken the previous one, that one is missed."""
        self.present = value
        for end in self.ends:
            session = self.sessions.get(end)
            if session is not None:
                self.missed += session.available
                session.missed = session.missed or session.available
                session.available = True
                self.world.notice()

    def begin(self, end: EndKey, *, available: bool) -> Session:
        """Begin the session of an end, at its first read."""
        self.sessions[end] = Session(self.world.now, available)
        return self.sessions[end]

    def ready(self, offer: Offer) -> bool:
        """Whether there is a sample not yet taken.

        Without a session, the present sample counts if the process already follows this period.
        """
        session = self.sessions.get(offer.end)
        return self._followed(offer.end) if session is None else session.available

    def _followed(self, end: EndKey) -> bool:
        """Whether the process of the end already followed this period at the present tick, through another end."""
        tick = self.sampling.latest_tick(self.world.now)
        return any(
            other_end[0] == end[0] and session.since < tick
            for port in self.world.inputs
            if isinstance(port, SampledInput) and port.sampling == self.sampling
            for other_end, session in port.sessions.items()
        )

    def take(self, end: EndKey) -> Any:
        """The latest sample. Raises MissedSampleError, once, if one was missed."""
        session = self.sessions.get(end) or self.begin(end, available=True)
        if session.missed and self.world.timeouts:
            session.missed = False
            raise MissedSampleError(f"a sample of {self.name} was overwritten before it had been taken")
        session.available = session.missed = False
        return self.present

    def process_ended(self, path: str) -> None:
        """End the sessions of a process: its next read is a first read."""
        self.sessions = {end: session for end, session in self.sessions.items() if end[0] != path}


def begin_sessions(offers: list[Offer]) -> None:
    """Begin the sessions of the first reads among all offers that a process makes together. «Time»"""
    new = [o for o in offers if isinstance(o.medium, SampledInput) and o.end not in o.medium.sessions]
    found = [(o, o.medium.ready(o)) for o in new]
    for offer, available in found:
        assert isinstance(offer.medium, SampledInput)
        offer.medium.begin(offer.end, available=available)
