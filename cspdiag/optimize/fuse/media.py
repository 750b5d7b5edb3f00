"""Channels and sampled inputs in symbolic execution.

Which processes wait at them, which of them communicate, and in what order is defined by the semantics of the language.
Only the expressions of values are known: when a value is passed, the ``Recorder`` records an assignment and, for the
trace, a report.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol, assert_never

from cspdiag.base import Span
from cspdiag.model.sampling import Sampling
from cspdiag.network.ir.actions import End, Target
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.network import LocalChannel
from cspdiag.optimize.fuse.code import NotStaticError
from cspdiag.semantics import media
from cspdiag.semantics.media import EndKey, World
from cspdiag.semantics.outside import SampledInput, Session


class Place(Protocol):
    """The task that makes offers, and its position."""

    key: tuple[int, ...]
    position: int


@dataclass(eq=False, kw_only=True)
class Offer(media.Offer):
    """An offer to communicate once, whose value is an expression."""

    place: Place
    source: End
    number: int
    """Distinguishes the offers of one place."""
    span: Span
    target: Target | None = None

    @property
    def key(self) -> tuple[object, ...]:
        """Identifies the offer in a state."""
        return (self.place.key, self.number)


def as_offer(offer: media.Offer) -> Offer:
    """The offer with its symbolic fields: all offers here have them."""
    assert isinstance(offer, Offer)
    return offer


class Records(Protocol):
    """Records what the media do."""

    def communicate(self, channel: str, value: Expression, offer: Offer) -> None:
        """A value is passed to the target of an offer."""

    def keep(self, offer: Offer, slot: int) -> Expression:
        """The value of a writer enters a buffer; returns the expression that then represents it."""

    def give(self, offer: Offer, value: Expression) -> None:
        """A buffered value is passed to the target of an offer; this is no communication."""

    def sample(self, offer: Offer, fresh: bool) -> None:
        """A sample is taken; ``fresh`` if it arrived at this instant."""

    def at_once(self, offer: Offer) -> None:
        """A variable is read, or it or an output is written."""

    def compute(self, offer: Offer) -> None:
        """The value of a writer is computed before it waits."""


class Medium(media.Medium):
    """A channel or input at which processes wait."""

    def __init__(self, record: Records, world: World, name: str, *arguments: Any) -> None:
        super().__init__(world, name, *arguments)
        self.record = record

    def state(self) -> tuple[object, ...]:
        """The part of the state on which future communications depend."""
        return tuple(as_offer(offer).key for offer in self.offers)

    def park(self, offer: media.Offer) -> None:
        """Let an offer wait; its value is computed first."""
        if offer.writes:
            self.record.compute(as_offer(offer))
        super().park(offer)

    def hand(self, writer: media.Offer, reader: media.Offer) -> None:
        """Pass the value."""
        self.record.communicate(self.name, writer.value, as_offer(reader))


class NonBlocking(Medium, media.NonBlocking):
    """A medium that never waits: a variable, or an output to the environment."""

    def arrive(self, offer: media.Offer) -> None:
        """Read the variable, or write it or the output."""
        self.record.at_once(as_offer(offer))
        self.complete(offer)


class Rendezvous(Medium, media.Rendezvous):
    """A channel of kind ``sync`` or ``any``."""


class Fifo(Medium, media.Fifo):
    """A channel of kind ``buffer`` or ``overwrite``; each value is kept in a variable, whose number is in
    ``values``.
    """

    def state(self) -> tuple[object, ...]:
        """See ``Medium.state``."""
        return (*super().state(), *(slot for slot, _ in self.values))

    def park(self, offer: media.Offer) -> None:
        """Let an offer wait; the value of one that enters immediately is computed when it enters."""
        if self.ready(offer):
            self.offers.append(offer)
        else:
            super().park(offer)

    def put(self, offer: media.Offer) -> None:
        """Let the value enter, in place of the oldest if there is no room."""
        if len(self.values) == self.capacity:
            self.values.pop(0)
        slot = min(set(range(self.capacity)) - {slot for slot, _ in self.values})
        self.values.append((slot, self.record.keep(as_offer(offer), slot)))

    def take(self, offer: media.Offer) -> None:
        """Pass the oldest value to a reader."""
        self.record.give(as_offer(offer), self.values.pop(0)[1])


class Broadcast(Medium, media.Broadcast):
    """A channel of which every reading end takes every value; the writer continues when all have."""

    def state(self) -> tuple[object, ...]:
        """See ``Medium.state``."""
        writing = () if self.writing is None else (as_offer(self.writing).key, *self.missing)
        return (*super().state(), writing)

    def arrive(self, offer: media.Offer) -> None:
        """Compute the value of a writer once for all readers."""
        if offer.writes:
            self.record.compute(as_offer(offer))
        super().arrive(offer)


class Input(Medium, SampledInput):
    """A sampled input. Only programs that miss no sample are followed, so the next sample to take is that of the latest
    tick.
    """

    def __init__(self, record: Records, world: World, name: str, sampling: Sampling) -> None:
        super().__init__(record, world, name, sampling)
        self.since: dict[EndKey, int] = {}
        """The instant at which each end was first waited at."""

    def state(self) -> tuple[object, ...]:
        """See ``Medium.state``."""
        tick = self.sampling.latest_tick(self.world.now)
        sessions = ((end, session.since < tick, session.available) for end, session in self.sessions.items())
        return (*super().state(), frozenset(sessions))

    def begin(self, end: EndKey, *, available: bool) -> Session:
        """The first read at an end."""
        self.since.setdefault(end, self.world.now)
        return super().begin(end, available=available)

    def sampled(self, value: object) -> None:
        """Take over a sample. Raises NotStaticError if the previous one was missed."""
        super().sampled(value)
        if self.missed:
            raise NotStaticError(f"samples of {self.name} are missed")

    def retry(self, offer: media.Offer) -> None:
        """Take the sample if there is one, otherwise wait."""
        if self.ready(offer):
            self.take(offer.end)
            self.record.sample(as_offer(offer), self.sampling.is_tick(self.world.now))
            self.complete(offer)


def channel_medium(record: Records, world: World, channel: LocalChannel, ends: Sequence[EndKey]) -> Medium:
    """The medium of a channel with these reading ends."""
    medium: Medium
    match channel.kind:
        case "sync" | "any":
            medium = Rendezvous(record, world, channel.name)
        case "broadcast":
            medium = Broadcast(record, world, channel.name)
        case "buffer" | "overwrite":
            assert channel.capacity is not None
            medium = Fifo(record, world, channel.name, channel.capacity, channel.kind == "overwrite")
        case "var":
            medium = NonBlocking(record, world, channel.name)
        case _:
            assert_never(channel.kind)
    for end in ends:
        medium.register(end)
    return medium
