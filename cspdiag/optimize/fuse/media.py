"""Channels and sampled inputs as they are followed at compile time: who waits at them, in which order, and what happens where two meet.

These are the rules of the language. Values are not known, only the expressions that they come from: where a value passes, the ``Follower`` writes down
an assignment and, for the trace, a report.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, assert_never

from cspdiag.base import Span
from cspdiag.network.ir.actions import End, Target
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.network import LocalChannel
from cspdiag.optimize.fuse.code import NotStaticError
from cspdiag.optimize.fuse.tasks import Task


class Follower(Protocol):
    """Writes down what happens."""

    now: int

    def communicate(self, channel: str, value: Expression, offer: Offer) -> None:
        """A value passes to the target of an offer."""

    def keep(self, offer: Offer, slot: int) -> Expression:
        """The value of a writer enters a buffer; gives what stands for it."""

    def give(self, offer: Offer, value: Expression) -> None:
        """A value that was kept comes to the target of an offer; no communication."""

    def sample(self, offer: Offer, fresh: bool) -> None:
        """A sample is taken; ``fresh`` tells that it came at this instant."""

    def at_once(self, offer: Offer) -> None:
        """A variable is read, or it or an output is written."""

    def compute(self, offer: Offer) -> None:
        """The value of a writer that goes on to wait is computed."""

    def follows(self, end: End, period: int) -> bool:
        """Whether the process of an end followed a period before the present tick."""

    def notice(self) -> None:
        """Wake whoever may go on now."""


class Offering(Protocol):
    """What a task waits for with offers."""

    task: Task

    def offer_done(self, offer: Offer) -> None:
        """The communication of an offer has been made."""

    def resolve(self, offer: Offer) -> None:
        """Somebody has chosen to communicate with this guard."""

    def bind(self, offer: Offer) -> None:
        """Somebody is going to communicate with this output guard."""


@dataclass(eq=False)
class Offer:
    """A wish to communicate once; ``guard`` is the branch of an alternative, None for a plain one."""

    request: Offering
    medium: Medium
    end: End
    number: int
    span: Span
    target: Target | None = None
    value: Expression | None = None
    guard: int | None = None
    only_ready: bool = False
    done: bool = False

    @property
    def task(self) -> Task:
        """Whose wish it is."""
        return self.request.task

    @property
    def writes(self) -> bool:
        """Whether it is one to write."""
        return self.value is not None

    @property
    def key(self) -> tuple[object, ...]:
        """Tells offers apart in a state."""
        return (self.task.key, self.number)


class Medium:
    """Keeps the offers that wait, in the order in which they came."""

    outside = False

    def __init__(self, world: Follower, name: str) -> None:
        self.world = world
        self.name = name
        self.offers: list[Offer] = []

    def state(self) -> tuple[object, ...]:
        """What the future depends on."""
        return tuple(offer.key for offer in self.offers)

    def withdraw(self, offer: Offer) -> None:
        """The offer no longer holds."""
        if offer in self.offers:
            self.offers.remove(offer)

    def park(self, offer: Offer) -> None:
        """Begins to wait."""
        if offer.writes:
            self.world.compute(offer)
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

    def opposite(self, offer: Offer) -> list[Offer]:
        """The offers of others that this one could meet."""
        return [o for o in self.offers if o.writes != offer.writes and o.task is not offer.task]

    def complete(self, offer: Offer) -> None:
        """The communication of an offer has been made."""
        self.withdraw(offer)
        offer.done = True
        offer.request.offer_done(offer)


class AtOnce(Medium):
    """What never waits: variables, and outputs to the environment."""

    def arrive(self, offer: Offer) -> None:
        """See ``Medium.arrive``."""
        self.world.at_once(offer)
        self.complete(offer)

    def ready(self, offer: Offer) -> bool:
        """See ``Medium.ready``."""
        return True

    def choose(self, offer: Offer) -> None:
        """See ``Medium.choose``."""
        self.arrive(offer)


class Rendezvous(Medium):
    """A channel of kind ``sync`` or ``any``."""

    def arrive(self, offer: Offer) -> None:
        """See ``Medium.arrive``."""
        plain = [partner for partner in self.opposite(offer) if partner.guard is None]
        if plain:
            self._pass(offer, plain[0])
        else:
            self.park(offer)

    def ready(self, offer: Offer) -> bool:
        """See ``Medium.ready``."""
        return bool(self.opposite(offer))

    def choose(self, offer: Offer) -> None:
        """See ``Medium.choose``."""
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
        assert writer.value is not None
        self.world.communicate(self.name, writer.value, reader)
        self.complete(one)
        self.complete(other)


class Fifo(Medium):
    """A channel of kind ``buffer`` or ``overwrite``: a value communicates when it enters; each is kept in a variable of its own."""

    def __init__(self, world: Follower, name: str, capacity: int, overwriting: bool) -> None:
        super().__init__(world, name)
        self.capacity = capacity
        self.overwriting = overwriting
        self.values: list[tuple[int, Expression]] = []

    def state(self) -> tuple[object, ...]:
        """See ``Medium.state``."""
        return (*super().state(), *(slot for slot, _ in self.values))

    def ready(self, offer: Offer) -> bool:
        """See ``Medium.ready``."""
        if offer.writes:
            return self.overwriting or len(self.values) < self.capacity
        return bool(self.values)

    def choose(self, offer: Offer) -> None:
        """See ``Medium.choose``."""
        if offer.only_ready:
            offer.done = True
        else:
            self.arrive(offer)

    def arrive(self, offer: Offer) -> None:
        """See ``Medium.arrive``."""
        offer.guard = None
        if self.ready(offer):
            self.offers.append(offer)
        else:
            self.park(offer)
        while any(self._move(o) for o in list(self.offers) if o.guard is None):
            pass

    def _move(self, offer: Offer) -> bool:
        if not self.ready(offer):
            return False
        if offer.value is not None:
            if len(self.values) == self.capacity:
                self.values.pop(0)
            slot = min(set(range(self.capacity)) - {slot for slot, _ in self.values})
            self.values.append((slot, self.world.keep(offer, slot)))
        else:
            self.world.give(offer, self.values.pop(0)[1])
        self.complete(offer)
        return True


class Broadcast(Medium):
    """Every reading end takes every value; the writer goes on when all have."""

    def __init__(self, world: Follower, name: str, ends: list[End]) -> None:
        super().__init__(world, name)
        self.ends = ends
        self.writing: Offer | None = None
        self.missing: list[End] = []

    def state(self) -> tuple[object, ...]:
        """See ``Medium.state``."""
        writing = () if self.writing is None else (self.writing.key, *self.missing)
        return (*super().state(), writing)

    def withdraw(self, offer: Offer) -> None:
        """See ``Medium.withdraw``."""
        super().withdraw(offer)
        if offer is self.writing:
            self.writing = None

    def arrive(self, offer: Offer) -> None:
        """See ``Medium.arrive``."""
        if offer.writes:
            self._write(offer)
        elif self.writing is not None and offer.end in self.missing:
            self._take(offer)
            self._all_taken()
        else:
            self.offers.append(offer)

    def _write(self, offer: Offer) -> None:
        self.world.compute(offer)
        self.writing, self.missing = offer, []
        for end in self.ends:
            self.missing.append(end)
            for reader in [o for o in self.offers if not o.writes and o.guard is None and o.end == end]:
                self._take(reader)
            self.world.notice()
        self._all_taken()

    def ready(self, offer: Offer) -> bool:
        """See ``Medium.ready``."""
        if offer.writes:
            return self._waited_at(self.ends, offer)
        return self.writing is not None and offer.end in self.missing

    def _waited_at(self, ends: list[End], offer: Offer) -> bool:
        return all(any(not o.writes and o.end == end and o.task is not offer.task for o in self.offers) for end in ends)

    def choose(self, offer: Offer) -> None:
        """See ``Medium.choose``."""
        raise NotStaticError(f"an alternative chooses to communicate on the broadcast {self.name}")

    def _take(self, reader: Offer) -> None:
        assert self.writing is not None
        assert self.writing.value is not None
        self.world.communicate(self.name, self.writing.value, reader)
        self.missing.remove(reader.end)
        self.complete(reader)

    def _all_taken(self) -> None:
        if self.writing is not None and not self.missing:
            writer, self.writing = self.writing, None
            self.complete(writer)


@dataclass
class Session:
    """The books of a reading end of a sampled input: since when it has one, and whether there is a sample that was not taken, which came at ``tick``."""

    since: int
    available: bool
    tick: int


class SampledInput(Medium):
    """Communicates at the instants k·period."""

    outside = True

    def __init__(self, world: Follower, name: str, period: int, ends: list[End]) -> None:
        super().__init__(world, name)
        self.period = period
        self.ends = ends
        self.sessions: dict[End, Session] = {}
        self.since: dict[End, int] = {}
        """When each end was waited at for the first time."""

    def state(self) -> tuple[object, ...]:
        """See ``Medium.state``."""
        sessions = ((end, s.since < self._tick(), s.available) for end, s in self.sessions.items())
        return (*super().state(), frozenset(sessions))

    def _tick(self) -> int:
        return self.world.now // self.period * self.period

    def sampled(self) -> None:
        """The instant of a sample."""
        for end in self.ends:
            session = self.sessions.get(end)
            if session is not None:
                if session.available:
                    raise NotStaticError(f"samples of {self.name} are missed")
                session.available, session.tick = True, self.world.now

    def ready(self, offer: Offer) -> bool:
        """See ``Medium.ready``."""
        session = self.sessions.get(offer.end)
        return self.world.follows(offer.end, self.period) if session is None else session.available

    def follows(self, end: End) -> bool:
        """Whether there has been a sample for this end before the present tick's."""
        session = self.sessions.get(end)
        return session is not None and session.since < self._tick()

    def begin(self, offer: Offer, available: bool) -> None:
        """A first read, which waits or takes the present tick's sample."""
        self.sessions[offer.end] = Session(self.world.now, available, self._tick())
        self.since.setdefault(offer.end, self.world.now)

    def arrive(self, offer: Offer) -> None:
        """See ``Medium.arrive``."""
        self.offers.append(offer)
        self.retry(offer)

    def retry(self, offer: Offer) -> None:
        """The process of a waiting reader runs."""
        if self.ready(offer):
            if offer.end not in self.sessions:
                self.begin(offer, True)
            session = self.sessions[offer.end]
            session.available = False
            self.world.sample(offer, session.tick == self.world.now)
            self.complete(offer)

    def choose(self, offer: Offer) -> None:
        """See ``Medium.choose``."""
        if offer.only_ready:
            offer.done = True
        else:
            offer.guard = None
            self.arrive(offer)


def channel_medium(world: Follower, channel: LocalChannel, ends: list[End]) -> Medium:
    """The medium of a channel with these reading ends."""
    match channel.kind:
        case "sync" | "any":
            return Rendezvous(world, channel.name)
        case "broadcast":
            return Broadcast(world, channel.name, ends)
        case "buffer" | "overwrite":
            assert channel.capacity is not None
            return Fifo(world, channel.name, channel.capacity, channel.kind == "overwrite")
        case "var":
            return AtOnce(world, channel.name)
        case _:
            assert_never(channel.kind)
