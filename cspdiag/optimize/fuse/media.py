"""Channels and sampled inputs as they are followed at compile time.

Who waits at them, who meets whom, and in which order is what the meaning of the language says. Values are not known,
only the expressions that they come from: where a value passes, the ``Recorder`` writes down an assignment and, for the
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
    """Where a task is that makes offers."""

    key: tuple[int, ...]
    position: int


@dataclass(eq=False, kw_only=True)
class Offer(media.Offer):
    """A wish to communicate once, of which the value is an expression."""

    place: Place
    source: End
    number: int
    """Tells the offers of one place apart."""
    span: Span
    target: Target | None = None

    @property
    def key(self) -> tuple[object, ...]:
        """Tells offers apart in a state."""
        return (self.place.key, self.number)


def followed(offer: media.Offer) -> Offer:
    """All offers are such here."""
    assert isinstance(offer, Offer)
    return offer


class Records(Protocol):
    """Writes down what happens."""

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


class Medium(media.Medium):
    """What processes wait at, and what its future depends on."""

    def __init__(self, record: Records, world: World, name: str, *arguments: Any) -> None:
        super().__init__(world, name, *arguments)
        self.record = record

    def state(self) -> tuple[object, ...]:
        """What the future depends on."""
        return tuple(followed(offer).key for offer in self.offers)

    def park(self, offer: media.Offer) -> None:
        """A value that waits is computed first."""
        if offer.writes:
            self.record.compute(followed(offer))
        super().park(offer)

    def hand(self, writer: media.Offer, reader: media.Offer) -> None:
        """The value passes."""
        self.record.communicate(self.name, writer.value, followed(reader))


class AtOnce(Medium, media.AtOnce):
    """What never waits: variables, and outputs to the environment."""

    def arrive(self, offer: media.Offer) -> None:
        """The variable is read, or it or the output is written."""
        self.record.at_once(followed(offer))
        self.complete(offer)


class Rendezvous(Medium, media.Rendezvous):
    """A channel of kind ``sync`` or ``any``."""


class Fifo(Medium, media.Fifo):
    """A channel of kind ``buffer`` or ``overwrite``: each value is kept in a variable of its own, by its number in
    ``values``.
    """

    def state(self) -> tuple[object, ...]:
        """See ``Medium.state``."""
        return (*super().state(), *(slot for slot, _ in self.values))

    def park(self, offer: media.Offer) -> None:
        """A value that enters at once is computed there."""
        if self.ready(offer):
            self.offers.append(offer)
        else:
            super().park(offer)

    def put(self, offer: media.Offer) -> None:
        """The value enters, in the place of the oldest where there is no room."""
        if len(self.values) == self.capacity:
            self.values.pop(0)
        slot = min(set(range(self.capacity)) - {slot for slot, _ in self.values})
        self.values.append((slot, self.record.keep(followed(offer), slot)))

    def take(self, offer: media.Offer) -> None:
        """The oldest value comes to a reader."""
        self.record.give(followed(offer), self.values.pop(0)[1])


class Broadcast(Medium, media.Broadcast):
    """Every reading end takes every value; the writer goes on when all have."""

    def state(self) -> tuple[object, ...]:
        """See ``Medium.state``."""
        writing = () if self.writing is None else (followed(self.writing).key, *self.missing)
        return (*super().state(), writing)

    def arrive(self, offer: media.Offer) -> None:
        """The value of a writer is computed once for all readers."""
        if offer.writes:
            self.record.compute(followed(offer))
        super().arrive(offer)


class Input(Medium, SampledInput):
    """A sampled input. Only programs that miss no sample are followed, so that the sample to be taken is that of the
    latest tick.
    """

    def __init__(self, record: Records, world: World, name: str, sampling: Sampling) -> None:
        super().__init__(record, world, name, sampling)
        self.since: dict[EndKey, int] = {}
        """When each end was waited at for the first time."""

    def state(self) -> tuple[object, ...]:
        """See ``Medium.state``."""
        tick = self.sampling.latest_tick(self.world.now)
        sessions = ((end, session.since < tick, session.available) for end, session in self.sessions.items())
        return (*super().state(), frozenset(sessions))

    def begin(self, end: EndKey, *, available: bool) -> Session:
        """A first read."""
        self.since.setdefault(end, self.world.now)
        return super().begin(end, available=available)

    def sampled(self, value: object) -> None:
        """The instant of a sample. Raises NotStaticError where one is missed."""
        super().sampled(value)
        if self.missed:
            raise NotStaticError(f"samples of {self.name} are missed")

    def retry(self, offer: media.Offer) -> None:
        """Take the sample that is there, or wait on."""
        if self.ready(offer):
            self.take(offer.end)
            self.record.sample(followed(offer), self.sampling.is_tick(self.world.now))
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
            medium = AtOnce(record, world, channel.name)
        case _:
            assert_never(channel.kind)
    for end in ends:
        medium.register(end)
    return medium
