"""The media that processes communicate through: channels of all kinds.

An offer is one pending read or write of one process. It is either plain (a reader or writer) or the guard of an
alternative. The party that arrives second performs the communication; a plain party never chooses a guard of an
alternative, but only wakes it.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any, Protocol

from cspdiag.semantics.values import FaultError

EndKey = tuple[str, str, int | None, int]
"""A reading end: the path of the process that it belongs to, its port or channel, the index of the port, and the number
of the end.
"""


Place = tuple[str, int | None]
"""A port, by its name and, in an array of ports, its index."""


class World(Protocol):
    """The part of the scheduler that media use. «Scheduling and traces»"""

    now: int
    timeouts: bool
    """Whether a missed sample is an exception for its reader."""

    @property
    def inputs(self) -> Sequence[Medium]:
        """The inputs of the program."""

    def communicate(self, channel: str, value: Any, writer: str = "", reader: str = "") -> None:
        """Record a communication; the paths of the processes are empty for the environment and for buffers. «Traces»"""

    def hand_over(self, channel: str, value: Any) -> None:
        """Hand a value over to the environment. «Time»"""

    def notice(self) -> None:
        """Wake every task that may continue now, because of one event. «Parties, channels and guards»"""


class Offering(Protocol):
    """A request that makes offers: a read, a write or an alternative. «Parties, channels and guards»"""

    @property
    def task(self) -> object:
        """The process."""

    def offer_done(self, offer: Offer) -> None:
        """The communication of an offer has taken place."""

    def resolve(self, offer: Offer) -> None:
        """Another process has chosen to communicate with this guard."""

    def bind(self, offer: Offer) -> None:
        """Another process is going to communicate with this output guard."""


@dataclasses.dataclass(eq=False)
class Offer:
    """One pending read or write; ``guard`` is its index in an alternative, None for a plain offer.

    «Parties, channels and guards»
    """

    request: Offering
    medium: Medium
    end: EndKey
    writes: bool
    value: Any = None
    guard: int | None = None
    only_ready: bool = False
    """Whether it is a ready guard, which does not itself read."""
    done: bool = False

    @property
    def task(self) -> object:
        """The process that makes the offer."""
        return self.request.task


class Medium:
    """A medium; keeps the offers that wait, in the order in which they arrived. «Parties, channels and guards»"""

    outside = False
    """Whether readers wait for the environment."""

    def __init__(self, world: World, name: str) -> None:
        self.world = world
        self.name = name
        self.offers: list[Offer] = []
        self.ends: list[EndKey] = []

    def register(self, end: EndKey) -> None:
        """Add a reading end; ends are served in the order of the program.

        «Parties, channels and guards»
        """
        if end not in self.ends:
            self.ends.append(end)

    def withdraw(self, offer: Offer) -> None:
        """Withdraw an offer: another guard was chosen, or its process ends. «Alternative», «Cancellation» 1"""
        if offer in self.offers:
            self.offers.remove(offer)

    def park(self, offer: Offer) -> None:
        """The offer begins to wait."""
        self.offers.append(offer)

    def arrive(self, offer: Offer) -> None:
        """A plain offer is made: it communicates at once, or waits. «Rendezvous»"""
        raise NotImplementedError

    def ready(self, offer: Offer) -> bool:
        """Whether a guard can be chosen. «Guards»"""
        raise NotImplementedError

    def choose(self, offer: Offer) -> None:
        """The guard has been chosen, and the other guards of its alternative withdrawn. «Alternative»"""
        raise NotImplementedError

    def retry(self, offer: Offer) -> None:
        """The process of a waiting plain offer runs again."""

    def wakes(self, offer: Offer) -> bool:
        """Whether the process of a waiting plain offer may continue."""
        return self.outside and self.ready(offer)

    def opposite(self, offer: Offer) -> list[Offer]:
        """The offers of other processes that this one can communicate with."""
        return [o for o in self.offers if o.writes != offer.writes and o.task is not offer.task]

    def hand(self, writer: Offer, reader: Offer) -> None:
        """Copy the value, and extend the trace. «Rendezvous», «Traces»"""
        reader.value = writer.value
        self.world.communicate(self.name, reader.value, writer.end[0], reader.end[0])

    def complete(self, offer: Offer) -> None:
        """The communication of an offer has taken place."""
        self.withdraw(offer)
        offer.done = True
        offer.request.offer_done(offer)


class Rendezvous(Medium):
    """A channel of kind ``sync`` or ``any``. «Parties, channels and guards»"""

    def arrive(self, offer: Offer) -> None:
        """Communicate with the first plain party that waits on the other side, or wait; never with a guard."""
        plain = [partner for partner in self.opposite(offer) if partner.guard is None]
        if plain:
            self._pass(offer, plain[0])
        else:
            self.park(offer)

    def ready(self, offer: Offer) -> bool:
        """Whether a plain party or a guard waits on the other side."""
        return bool(self.opposite(offer))

    def choose(self, offer: Offer) -> None:
        """Communicate with a plain party, or else with the alternative that has waited longest, whose guard is chosen
        by that.
        """
        # Plain parties are served before alternatives, which may still choose another guard.
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
        """Whether there is room for a writer, which ``overwrite`` always makes, or a value for a reader."""
        if offer.writes:
            return self.overwriting or len(self.values) < self.capacity
        return bool(self.values)

    def choose(self, offer: Offer) -> None:
        """Put or take a value; a ready guard leaves it to the read that follows."""
        if offer.only_ready:
            offer.done = True
        else:
            self.arrive(offer)

    def arrive(self, offer: Offer) -> None:
        """Put or take a value, and then do what this makes possible for waiting readers and writers."""
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
        """The value communicates and enters; it replaces the oldest one if there is no room."""
        self.world.communicate(self.name, offer.value, offer.end[0])
        self.values = [*self.values, offer.value][-self.capacity :]

    def take(self, offer: Offer) -> None:
        """The oldest value leaves to a reader."""
        offer.value = self.values.pop(0)


class Broadcast(Medium):
    """A channel of kind ``broadcast``: every reading end takes every value; the writer continues when all have taken
    it.

    «Parties, channels and guards»
    """

    def __init__(self, world: World, name: str) -> None:
        super().__init__(world, name)
        self.writing: Offer | None = None
        self.missing: list[EndKey] = []

    def withdraw(self, offer: Offer) -> None:
        """Withdraw an offer; a withdrawn writer takes its value back."""
        super().withdraw(offer)
        if offer is self.writing:
            self.writing = None

    def arrive(self, offer: Offer) -> None:
        """A reader takes the value if its end has not taken it, or waits; a writer serves the ends."""
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
        """Whether a process waits at every end, for a guard that writes; or whether the end has a value not yet taken,
        for a guard that reads.
        """
        if offer.writes:
            return self._waited_at(self.ends, offer)
        return self.writing is not None and offer.end in self.missing

    def _waited_at(self, ends: list[EndKey], offer: Offer) -> bool:
        return all(any(not o.writes and o.end == end and o.task is not offer.task for o in self.offers) for end in ends)

    def choose(self, offer: Offer) -> None:
        """Communicate by a guard; between two alternatives only the writer, which sees all ends, can choose."""
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


class NonBlocking(Medium):
    """A medium at which no process waits.

    Readers get ``value``. A plain read or write is not a communication, and no process is cancelled there.
    «Cancellation»
    """

    communicates = False

    def __init__(self, world: World, name: str, value: Any = None) -> None:
        super().__init__(world, name)
        self.value = value

    def ready(self, offer: Offer) -> bool:
        """Always true."""
        return True

    def choose(self, offer: Offer) -> None:
        """Read or write at once."""
        if offer.only_ready:
            offer.done = True
        else:
            self.arrive(offer)

    def arrive(self, offer: Offer) -> None:
        """Read or write at once."""
        if offer.writes:
            self.write(offer.value)
        else:
            offer.value = self.value
        self.complete(offer)

    def write(self, value: Any) -> None:
        """Take a value that is written; ``_`` drops it."""


class Variable(NonBlocking):
    """A channel of kind ``var``.

    It holds one value, and is overwritten; accesses are not communications. Reading it before it is written is a fault.
    «Faults»
    """

    @property
    def value(self) -> Any:
        """The value that was written last."""
        if self.present is None:
            raise FaultError(f"{self.name} is read before it was written")
        return self.present

    @value.setter
    def value(self, value: Any) -> None:
        self.present = value

    def write(self, value: Any) -> None:
        """Overwrite the value."""
        self.value = value
