"""What processes communicate through: channels of all kinds, and the ports of the outermost process.

An offer is the wish of one process to read or to write once. It is either plain (a reader or writer), or the guard of an alternative.
The party that arrives second makes the communication; a plain party never decides for an alternative, which is only woken by it.
"""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING, Any

from cspdiag.semantics.values import RaisedFaultError

if TYPE_CHECKING:
    from cspdiag.semantics.requests import Request
    from cspdiag.semantics.scheduler import Scheduler, Task

EndKey = tuple[str, str, int | None, int]
"""A reading end: the path of the process that owns it, its port or channel, the index of the port, the number of the end."""


class RaisedTimeoutError(Exception):
    """A sample was overwritten before it was taken."""


@dataclasses.dataclass(eq=False)
class Offer:
    """A wish to communicate once; ``guard`` is the index in an alternative, None for a plain one."""

    request: Request
    medium: Medium
    end: EndKey
    writes: bool
    value: Any = None
    guard: int | None = None
    only_ready: bool = False
    """A guard that does not itself read."""
    done: bool = False

    @property
    def task(self) -> Task:
        return self.request.task


class Medium:
    """Keeps the offers that wait, in the order in which they came."""

    outside = False
    """Whether a reader waits for the environment."""

    def __init__(self, world: Scheduler, name: str) -> None:
        self.world = world
        self.name = name
        self.offers: list[Offer] = []
        self.ends: list[EndKey] = []

    def register(self, end: EndKey) -> None:
        """There is a reading end; ends are served in the order in which they stand in the program."""
        if end not in self.ends:
            self.ends.append(end)

    def withdraw(self, offer: Offer) -> None:
        """The offer no longer holds."""
        if offer in self.offers:
            self.offers.remove(offer)

    def park(self, offer: Offer) -> None:
        """The guard of an alternative begins to wait."""
        self.offers.append(offer)

    def arrive(self, offer: Offer) -> None:
        """A plain offer is made: it is done, or waits."""
        raise NotImplementedError

    def ready(self, offer: Offer) -> bool:
        """Whether the guard could be chosen."""
        raise NotImplementedError

    def choose(self, offer: Offer) -> None:
        """The guard has been chosen, and the other guards of its alternative withdrawn."""
        raise NotImplementedError

    def retry(self, offer: Offer) -> None:
        """The process of a waiting plain offer runs again."""

    def wakes(self, offer: Offer) -> bool:
        """Whether the process of a waiting plain offer may go on."""
        return self.outside and self.ready(offer)

    def opposite(self, offer: Offer) -> list[Offer]:
        """The offers of others that this one could meet."""
        return [o for o in self.offers if o.writes != offer.writes and o.task is not offer.task]

    def complete(self, offer: Offer) -> None:
        """The communication of an offer has been made."""
        self.withdraw(offer)
        offer.done = True
        offer.request.offer_done(offer)


class Rendezvous(Medium):
    """A channel of kind ``sync`` or ``any``."""

    def arrive(self, offer: Offer) -> None:
        plain = [partner for partner in self.opposite(offer) if partner.guard is None]
        if plain:
            self._pass(offer, plain[0])
        else:
            self.offers.append(offer)

    def ready(self, offer: Offer) -> bool:
        return bool(self.opposite(offer))

    def choose(self, offer: Offer) -> None:
        # Those that merely read or write are served before alternatives, which may still choose something else.
        partner = min(self.opposite(offer), key=lambda o: o.guard is not None)
        if offer.only_ready:
            offer.done = True
            if partner.guard is not None:
                partner.request.bind(partner)
        elif partner.only_ready:
            partner.request.resolve(partner)
            offer.guard = None
            self.arrive(offer)
        else:
            if partner.guard is not None:
                partner.request.resolve(partner)
            self._pass(offer, partner)

    def _pass(self, one: Offer, other: Offer) -> None:
        writer, reader = (one, other) if one.writes else (other, one)
        self.world.communicate(self.name, writer.value)
        reader.value = writer.value
        self.complete(one)
        self.complete(other)


class Fifo(Medium):
    """A channel of kind ``buffer`` or ``overwrite``: a value communicates when it enters."""

    def __init__(self, world: Scheduler, name: str, capacity: int, overwriting: bool) -> None:
        super().__init__(world, name)
        self.capacity = capacity
        self.overwriting = overwriting
        self.values: list[Any] = []

    def ready(self, offer: Offer) -> bool:
        if offer.writes:
            return self.overwriting or len(self.values) < self.capacity
        return bool(self.values)

    def choose(self, offer: Offer) -> None:
        if offer.only_ready:
            offer.done = True
        else:
            self.arrive(offer)

    def arrive(self, offer: Offer) -> None:
        self.offers.append(offer)
        offer.guard = None
        while any(self._move(o) for o in list(self.offers) if o.guard is None):
            pass

    def _move(self, offer: Offer) -> bool:
        if not self.ready(offer):
            return False
        if offer.writes:
            self.world.communicate(self.name, offer.value)
            self.values = [*self.values, offer.value][-self.capacity :]
        else:
            offer.value = self.values.pop(0)
        self.complete(offer)
        return True


class Broadcast(Medium):
    """Every reading end takes every value; the writer goes on when all have."""

    def __init__(self, world: Scheduler, name: str) -> None:
        super().__init__(world, name)
        self.writing: Offer | None = None
        self.missing: list[EndKey] = []

    def withdraw(self, offer: Offer) -> None:
        super().withdraw(offer)
        if offer is self.writing:
            self.writing = None

    def arrive(self, offer: Offer) -> None:
        if offer.writes:
            self._write(offer)
        elif self.writing is not None and offer.end in self.missing:
            self._take(offer)
            self._all_taken()
        else:
            self.offers.append(offer)

    def _write(self, offer: Offer) -> None:
        self.writing, self.missing = offer, []
        for end in self.ends:
            self.missing.append(end)
            for reader in [o for o in self.offers if not o.writes and o.guard is None and o.end == end]:
                self._take(reader)
            self.world.notice()
        self._all_taken()

    def ready(self, offer: Offer) -> bool:
        if offer.writes:
            return self._waited_at(self.ends, offer)
        return self.writing is not None and offer.end in self.missing

    def _waited_at(self, ends: list[EndKey], offer: Offer) -> bool:
        return all(any(not o.writes and o.end == end and o.task is not offer.task for o in self.offers) for end in ends)

    def choose(self, offer: Offer) -> None:
        if offer.writes:
            readers = [o for o in self.opposite(offer) if o.guard is not None]
            for reader in readers:
                reader.request.resolve(reader)
            offer.guard = None
            self.arrive(offer)
            for reader in readers:
                if not reader.only_ready:
                    self._take(reader)
            self._all_taken()
            return
        if offer.only_ready:
            offer.done = True
        else:
            self._take(offer)
            self._all_taken()

    def _take(self, reader: Offer) -> None:
        assert self.writing is not None
        self.world.communicate(self.name, self.writing.value)
        reader.value = self.writing.value
        self.missing.remove(reader.end)
        self.complete(reader)

    def _all_taken(self) -> None:
        if self.writing is not None and not self.missing:
            writer, self.writing = self.writing, None
            self.complete(writer)


class AtOnce(Medium):
    """What never waits: readers get what ``value`` says. A read or a write by itself is no communication, and no process is cancelled there."""

    communicates = False

    def __init__(self, world: Scheduler, name: str, value: Any = None) -> None:
        super().__init__(world, name)
        self.value = value

    def ready(self, offer: Offer) -> bool:
        return True

    def choose(self, offer: Offer) -> None:
        if offer.only_ready:
            offer.done = True
        else:
            self.arrive(offer)

    def arrive(self, offer: Offer) -> None:
        if offer.writes:
            self.write(offer.value)
        else:
            offer.value = self.value
        self.complete(offer)

    def write(self, value: Any) -> None:
        """Take what was written."""


class Variable(AtOnce):
    """A channel of kind ``var``: one place, overwriting; no communication. To read it before it was written is a fault."""

    @property
    def value(self) -> Any:
        """What was written last."""
        if self.present is None:
            raise RaisedFaultError(f"{self.name} is read before it was written")
        return self.present

    @value.setter
    def value(self, value: Any) -> None:
        self.present = value

    def write(self, value: Any) -> None:
        self.value = value


class EventOutput(AtOnce):
    """An output that hands each value to the environment at the write: an event port, or an ``immediate`` one."""

    communicates = True

    def write(self, value: Any) -> None:
        _refuse_what_is_no_number(value)
        self.world.hand_over(self.name, value)


class SampledOutput(AtOnce):
    """A latch of one place that is handed over at the next tick."""

    communicates = True

    def __init__(self, world: Scheduler, name: str, period: int) -> None:
        super().__init__(world, name)
        self.period = period
        self.latched: list[Any] = []

    def write(self, value: Any) -> None:
        _refuse_what_is_no_number(value)
        self.latched = [value]

    def tick(self) -> None:
        """Hand over what was written since the last tick."""
        for value in self.latched:
            self.world.hand_over(self.name, value)
        self.latched = []


def _refuse_what_is_no_number(value: Any) -> None:
    if isinstance(value, tuple):
        for part in value:
            _refuse_what_is_no_number(part)
    elif isinstance(value, float) and not math.isfinite(value):
        raise RaisedFaultError(f"{value} for an output of the outermost process")


class ExternalInput(Medium):
    """A waiting reader is woken when there is something, and takes it when it runs."""

    outside = True

    present: Any = None
    """What the environment says."""

    def arrive(self, offer: Offer) -> None:
        self.offers.append(offer)
        self.retry(offer)

    def retry(self, offer: Offer) -> None:
        if self.ready(offer):
            offer.value = self.take(offer.end)
            self.world.communicate(self.name, offer.value)
            self.complete(offer)

    def choose(self, offer: Offer) -> None:
        if offer.only_ready:
            offer.done = True
        else:
            self.retry(offer)

    def take(self, end: EndKey) -> Any:
        """The value; it is no longer there for this end."""
        raise NotImplementedError


class EventInput(ExternalInput):
    """Keeps the latest value offered until it is read; under ``broadcast`` each end has its own."""

    def __init__(self, world: Scheduler, name: str, broadcast: bool) -> None:
        super().__init__(world, name)
        self.broadcast = broadcast
        self.latches: dict[EndKey | None, Any] = {}

    def offered(self, value: Any) -> None:
        """The environment's output has a value at an instant of the grid; it is an event if it has changed."""
        if value != self.present:
            self.present = value
            for latch in self.ends if self.broadcast else [None]:
                self.latches[latch] = value
                self.world.notice()

    def _key(self, end: EndKey) -> EndKey | None:
        return end if self.broadcast else None

    def ready(self, offer: Offer) -> bool:
        return self._key(offer.end) in self.latches

    def wakes(self, offer: Offer) -> bool:
        waiting = [o for o in self.offers if o.guard is None and self._key(o.end) == self._key(offer.end)]
        return self.ready(offer) and waiting[0] is offer

    def take(self, end: EndKey) -> Any:
        return self.latches.pop(self._key(end))


@dataclasses.dataclass
class Session:
    """The books of a reading end of a sampled input."""

    since: int
    available: bool
    missed: bool = False


class SampledInput(ExternalInput):
    """Communicates at the instants k·period."""

    def __init__(self, world: Scheduler, name: str, period: int) -> None:
        super().__init__(world, name)
        self.period = period
        self.sessions: dict[EndKey, Session] = {}

    def sampled(self, value: Any) -> None:
        """The instant of a sample."""
        self.present = value
        for end in self.ends:
            session = self.sessions.get(end)
            if session is not None:
                session.missed = session.missed or session.available
                session.available = True
                self.world.notice()

    def ready(self, offer: Offer) -> bool:
        session = self.sessions.get(offer.end)
        return self._followed(offer.end) if session is None else session.available

    def _followed(self, end: EndKey) -> bool:
        """Whether the process of the end followed this period at the present tick already, through another end."""
        tick = self.world.now // self.period * self.period
        return any(
            other_end[0] == end[0] and session.since < tick
            for port in self.world.inputs
            if isinstance(port, SampledInput) and port.period == self.period
            for other_end, session in port.sessions.items()
        )

    def take(self, end: EndKey) -> Any:
        session = self.sessions.setdefault(end, Session(self.world.now, True))
        if session.missed and self.world.timeouts:
            session.missed = False
            raise RaisedTimeoutError
        session.available = session.missed = False
        return self.present

    def process_ended(self, path: str) -> None:
        """The ends of a process begin anew with its next first read."""
        self.sessions = {end: session for end, session in self.sessions.items() if end[0] != path}


def begin_sessions(offers: list[Offer]) -> None:
    """First reads, all that a process begins to wait for together."""
    new = [o for o in offers if isinstance(o.medium, SampledInput) and o.end not in o.medium.sessions]
    found = [(o, o.medium.ready(o)) for o in new]
    for offer, available in found:
        assert isinstance(offer.medium, SampledInput)
        offer.medium.sessions[offer.end] = Session(offer.medium.world.now, available)
