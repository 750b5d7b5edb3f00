"""What processes communicate through: the channels of all kinds.

An offer is the wish of one process to read or to write once. It is either plain (a reader or writer), or the guard of
an alternative. The party that arrives second makes the communication; a plain party never decides for an alternative,
which is only woken by it.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any, Protocol

from cspdiag.semantics.values import FaultError

EndKey = tuple[str, str, int | None, int]
"""A reading end: the path of the process that owns it, its port or channel, the index of the port, the number of the
end.
"""


Place = tuple[str, int | None]
"""A port, by its name and, in an array of ports, its index."""


class World(Protocol):
    """What media know of the run. «Scheduling and traces»"""

    now: int
    timeouts: bool
    """Whether a missed sample is an exception for its reader."""

    @property
    def inputs(self) -> Sequence[Medium]:
        """The inputs of the program."""

    def communicate(self, channel: str, value: Any, writer: str = "", reader: str = "") -> None:
        """A value passes; the paths of the processes are empty for the environment and for buffers. «Traces»"""

    def hand_over(self, channel: str, value: Any) -> None:
        """A value passes to the environment. «Time»"""

    def notice(self) -> None:
        """Wake every task that may continue now, because of one event. «Parties, channels and guards»"""


class Offering(Protocol):
    """What makes offers: a process reads, writes or alternates. «Parties, channels and guards»"""

    @property
    def task(self) -> object:
        """The process."""

    def offer_done(self, offer: Offer) -> None:
        """Somebody has made the communication of an offer."""

    def resolve(self, offer: Offer) -> None:
        """Somebody has chosen to communicate with this guard."""

    def bind(self, offer: Offer) -> None:
        """Somebody is going to communicate with this output guard."""


@dataclasses.dataclass(eq=False)
class Offer:
    """A wish to communicate once; ``guard`` is the index in an alternative, None for a plain one.

    «Parties, channels and guards»
    """

    request: Offering
    medium: Medium
    end: EndKey
    writes: bool
    value: Any = None
    guard: int | None = None
    only_ready: bool = False
    """A guard that does not itself read."""
    done: bool = False

    @property
    def task(self) -> object:
        """The process that makes it."""
        return self.request.task


class Medium:
    """Keeps the offers that wait, in the order in which they came. «Parties, channels and guards»"""

    outside = False
    """Whether a reader waits for the environment."""

    def __init__(self, world: World, name: str) -> None:
        self.world = world
        self.name = name
        self.offers: list[Offer] = []
        self.ends: list[EndKey] = []

    def register(self, end: EndKey) -> None:
        """There is a reading end; ends are served in the order in which they stand in the program.

        «Parties, channels and guards»
        """
        if end not in self.ends:
            self.ends.append(end)

    def withdraw(self, offer: Offer) -> None:
        """The offer no longer holds: another guard was chosen, or its process ends. «Alternative», «Cancellation» 1"""
        if offer in self.offers:
            self.offers.remove(offer)

    def park(self, offer: Offer) -> None:
        """It begins to wait."""
        self.offers.append(offer)

    def arrive(self, offer: Offer) -> None:
        """A plain offer is made: it is done, or waits. «Rendezvous»"""
        raise NotImplementedError

    def ready(self, offer: Offer) -> bool:
        """Whether the guard could be chosen. «Guards»"""
        raise NotImplementedError

    def choose(self, offer: Offer) -> None:
        """The guard has been chosen, and the other guards of its alternative withdrawn. «Alternative»"""
        raise NotImplementedError

    def retry(self, offer: Offer) -> None:
        """The process of a waiting plain offer runs again."""

    def wakes(self, offer: Offer) -> bool:
        """Whether the process of a waiting plain offer may go on."""
        return self.outside and self.ready(offer)

    def opposite(self, offer: Offer) -> list[Offer]:
        """The offers of others that this one could meet."""
        return [o for o in self.offers if o.writes != offer.writes and o.task is not offer.task]

    def hand(self, writer: Offer, reader: Offer) -> None:
        """The value is copied, and the trace extended. «Rendezvous», «Traces»"""
        reader.value = writer.value
        self.world.communicate(self.name, reader.value, writer.end[0], reader.end[0])

    def complete(self, offer: Offer) -> None:
        """The communication of an offer has been made."""
        self.withdraw(offer)
        offer.done = True
        offer.request.offer_done(offer)


class Rendezvous(Medium):
    """A channel of kind ``sync`` or ``any``. «Parties, channels and guards»"""

    def arrive(self, offer: Offer) -> None:
        """Meets the first plain party that waits on the other side, or waits; it never decides for an alternative."""
        plain = [partner for partner in self.opposite(offer) if partner.guard is None]
        if plain:
            self._pass(offer, plain[0])
        else:
            self.park(offer)

    def ready(self, offer: Offer) -> bool:
        """A party waits on the other side, or a guard."""
        return bool(self.opposite(offer))

    def choose(self, offer: Offer) -> None:
        """Communicate with a plain party, or else with the alternative that has waited longest: it has chosen, too."""
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
        self.hand(writer, reader)
        self.complete(one)
        self.complete(other)


class Fifo(Medium):
    """A channel of kind ``buffer`` or ``overwrite``: a value communicates when it enters.

    «Parties, channels and guards»
    """

    def __init__(self, world: World, name: str, capacity: int, overwriting: bool) -> None:
        super().__init__(world, name)
        self.capacity = capacity
        self.overwriting = overwriting
        self.values: list[Any] = []

    def ready(self, offer: Offer) -> bool:
        """There is room, which ``overwrite`` always makes; or there is a value."""
        if offer.writes:
            return self.overwriting or len(self.values) < self.capacity
        return bool(self.values)

    def choose(self, offer: Offer) -> None:
        """Put or take; a guard ``port`` leaves the value to the reader that follows."""
        if offer.only_ready:
            offer.done = True
        else:
            self.arrive(offer)

    def arrive(self, offer: Offer) -> None:
        """Put or take, and then whatever became possible with that: a value goes on to a reader that waits."""
        self.park(offer)
        offer.guard = None
        while any(self._move(o) for o in list(self.offers) if o.guard is None):
            pass

    def _move(self, offer: Offer) -> bool:
        if not self.ready(offer):
            return False
        if offer.writes:
            self.put(offer)
        else:
            self.take(offer)
        self.complete(offer)
        return True

    def put(self, offer: Offer) -> None:
        """The value communicates and enters, in the place of the oldest where there is no room."""
        self.world.communicate(self.name, offer.value, offer.end[0])
        self.values = [*self.values, offer.value][-self.capacity :]

    def take(self, offer: Offer) -> None:
        """The oldest value reaches a reader."""
        offer.value = self.values.pop(0)


class Broadcast(Medium):
    """A channel of kind ``broadcast``: every reading end takes every value; the writer goes on when all have.

    «Parties, channels and guards»
    """

    def __init__(self, world: World, name: str) -> None:
        super().__init__(world, name)
        self.writing: Offer | None = None
        self.missing: list[EndKey] = []

    def withdraw(self, offer: Offer) -> None:
        """The value of a writer that is taken back goes with it."""
        super().withdraw(offer)
        if offer is self.writing:
            self.writing = None

    def arrive(self, offer: Offer) -> None:
        """A reader takes the value that its end has not taken, or waits; a writer serves the ends."""
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
        """A guard that writes.

        Somebody waits at every end. One that reads: its end has a value that it has not taken.
        """
        if offer.writes:
            return self._waited_at(self.ends, offer)
        return self.writing is not None and offer.end in self.missing

    def _waited_at(self, ends: list[EndKey], offer: Offer) -> bool:
        return all(any(not o.writes and o.end == end and o.task is not offer.task for o in self.offers) for end in ends)

    def choose(self, offer: Offer) -> None:
        """Two alternatives meet by the choice of the writer alone, who sees all ends."""
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
        self.hand(self.writing, reader)
        self.missing.remove(reader.end)
        self.complete(reader)

    def _all_taken(self) -> None:
        if self.writing is not None and not self.missing:
            writer, self.writing = self.writing, None
            self.complete(writer)


class AtOnce(Medium):
    """What never waits.

    Readers get what ``value`` says. A read or a write by itself is no communication, and no process is cancelled
    there. «Cancellation»
    """

    communicates = False

    def __init__(self, world: World, name: str, value: Any = None) -> None:
        super().__init__(world, name)
        self.value = value

    def ready(self, offer: Offer) -> bool:
        """Always."""
        return True

    def choose(self, offer: Offer) -> None:
        """At once."""
        if offer.only_ready:
            offer.done = True
        else:
            self.arrive(offer)

    def arrive(self, offer: Offer) -> None:
        """At once."""
        if offer.writes:
            self.write(offer.value)
        else:
            offer.value = self.value
        self.complete(offer)

    def write(self, value: Any) -> None:
        """Take what was written; ``_`` drops it."""


class Variable(AtOnce):
    """A channel of kind ``var``.

    One place, overwriting; no communication. To read it before it was written is a fault. «Faults»
    """

    @property
    def value(self) -> Any:
        """What was written last."""
        if self.present is None:
            raise FaultError(f"{self.name} is read before it was written")
        return self.present

    @value.setter
    def value(self, value: Any) -> None:
        self.present = value

    def write(self, value: Any) -> None:
        """Overwrite it."""
        self.value = value
