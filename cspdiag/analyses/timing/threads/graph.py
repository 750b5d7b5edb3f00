"""The control flow of each thread of a program: where it computes, where it waits and for what.

A thread is what the scheduler switches between: the outermost process, and every branch of a parallel that has a loop
in it. The branches of a parallel without loops are work of the thread that starts them, one after another, since one
processor runs them so.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import ClassVar, Literal

from cspdiag.base import Span
from cspdiag.base.graphs import reached
from cspdiag.base.record import record

Key = tuple[str, str, int]
"""An end of a sampled input: its net, the process that keeps its books, and which of its ends."""

WaitKind = Literal["sample", "event", "delay", "partner", "join"]


@record
class Offer:
    """What a waiting thread goes on with.

    ``channel`` is the path of the net; ``period`` that of a sampled input, or how long a delay lasts, 0 where it is
    computed, and ``takes_time`` if that is longer than zero; ``key`` tells apart who keeps books of the samples of an
    input, and without ``takes`` a sample is only looked for; ``writes`` tells the side of a rendezvous; ``is_certain``
    unless it is there only where a condition holds, or abandons what waits. ``opens`` are the inputs, with their
    periods, that branches which are abandoned may have followed.
    """

    uncompared: ClassVar[frozenset[str]] = frozenset()

    kind: WaitKind
    target: int
    span: Span
    channel: str = ""
    period: int = 0
    key: Key = ("", "", 0)
    takes: bool = True
    takes_time: bool = False
    writes: bool = False
    is_certain: bool = True
    opens: frozenset[tuple[Key, int]] = frozenset()

    @property
    def end(self) -> tuple[str, bool]:
        """The side of a channel at which it communicates."""
        return self.channel, self.writes


@record
class Move:
    """Values pass from some channels and variables to others, by the paths of their nets."""

    reads: frozenset[str]
    writes: frozenset[str]


@dataclass(slots=True)
class Place:
    """A point of a thread: it computes for ``cost`` and goes on to one of ``successors``, or waits for one of
    ``offers``; an end has neither.

    ``leaf`` is the law or process that computes, ``outputs`` are the nets that it writes to the outside. ``breaks``
    tells that another thread may run before it goes on. ``starts`` is the path of a process that begins here, without
    samples of its own yet, and ``opens`` are the inputs that parts which begin together follow, though they come one
    after another here. ``polls`` tells that it takes an offer only where it need not wait for it, and may go on
    without. ``raises`` tells an end by an exception, ``halts`` a ``stop``. ``gives`` are the channels that it writes
    without ever waiting for who reads them. ``move`` is what it hands on, of a write before who reads is waited for, of
    a read after who writes was.
    """

    span: Span
    path: str
    cost: int = 0
    leaf: str = ""
    successors: list[int] = field(default_factory=list)
    offers: list[Offer] = field(default_factory=list)
    breaks: bool = False
    starts: str = ""
    opens: frozenset[tuple[Key, int]] = frozenset()
    polls: bool = False
    raises: bool = False
    halts: bool = False
    outputs: tuple[str, ...] = ()
    gives: tuple[str, ...] = ()
    move: Move | None = None

    @property
    def is_idle(self) -> bool:
        """Whether time may pass here whatever other threads do."""
        return any(offer.kind != "partner" for offer in self.offers)

    @property
    def is_end(self) -> bool:
        """Whether nothing comes after it, though no exception was raised."""
        return not self.offers and not self.successors and not self.raises

    def periods(self) -> frozenset[int]:
        """Those of which a sample is waited for."""
        return frozenset(offer.period for offer in self.offers if offer.kind == "sample")

    def certain_periods(self) -> frozenset[int]:
        """Those of which a sample, whatever holds, ends the wait."""
        return frozenset(offer.period for offer in self.offers if offer.kind == "sample" and offer.is_certain)

    def offers_end(self, channel: str, writes: bool) -> bool:
        """Whether who waits here takes part, whatever holds, in a communication on that side of a channel."""
        return any(
            offer.kind == "partner" and offer.is_certain and offer.end == (channel, writes) for offer in self.offers
        )

    def longest_delay(self) -> int | None:
        """After which the wait is over, whatever happens; None where no known time ends it."""
        known = [offer.period for offer in self.offers if offer.kind == "delay" and offer.is_certain and offer.period]
        return min(known, default=None)


@record
class Circle:
    """A loop of a thread: each round begins anew at the place ``again`` and passes others from there on, up to ``end``.
    ``ends`` says whether it surely ends if nothing in it waits forever; ``turns`` how many rounds it has, where that is
    known though they are too many to be followed one by one.
    """

    again: int
    end: int
    ends: Callable[[], bool]
    turns: int | None = None


@dataclass(slots=True)
class Thread:
    """A sequential part of the program. ``forks`` are the groups of threads that it starts and waits for, each at the
    place in ``joins``. ``shared`` are the processes, with the periods, of which other threads read sampled inputs, too;
    ``begins_at_once`` where the program begins with it.
    """

    path: str
    priority: tuple[int, ...]
    places: list[Place] = field(default_factory=list)
    entry: int = 0
    forks: list[list[Thread]] = field(default_factory=list)
    joins: list[int] = field(default_factory=list)
    circles: list[Circle] = field(default_factory=list)
    shared: frozenset[tuple[str, int]] = frozenset()
    begins_at_once: bool = False
    is_outermost: bool = False

    def with_forks(self) -> Iterator[Thread]:
        """The thread and all that it starts."""
        pending = [self]
        while pending:
            thread = pending.pop()
            yield thread
            pending += [inner for group in reversed(thread.forks) for inner in reversed(group)]

    def samples(self) -> frozenset[tuple[Key, int]]:
        """The ends of sampled inputs that the thread itself reads, with their periods."""
        offers = (offer for place in self.places for offer in place.offers)
        return frozenset((offer.key, offer.period) for offer in offers if offer.kind == "sample")

    def waits_first(self) -> set[int]:
        """The waits that it comes to from its beginning."""
        on_the_way = reached([self.entry], lambda number: self.places[number].successors)
        return {number for number in on_the_way if self.places[number].offers}

    def has_samples(self) -> bool:
        """Whether the thread follows a sample period."""
        return any(offer.kind == "sample" for place in self.places for offer in place.offers)


@record
class Missing:
    """A law or process that does not say its worst-case execution time; ``span`` is its definition."""

    uncompared: ClassVar[frozenset[str]] = frozenset()

    leaf: str
    definition: str
    kind: Literal["submodel", "process"]
    span: Span
