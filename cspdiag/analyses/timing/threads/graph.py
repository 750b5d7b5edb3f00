"""The control-flow graph of a thread: its nodes are places where it computes or waits.

A thread is what the scheduler switches between: the outermost process, and every branch of a parallel composition that
has a loop in it. The branches of a parallel composition without loops belong to the thread that starts them, one after
another, because that is how one processor runs them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import ClassVar, Literal

from cspdiag.base import Span
from cspdiag.base.graphs import reached
from cspdiag.base.record import record

InputEnd = tuple[str, str, int]
"""An end of a sampled input: its net, the process that follows samples there, and the number of the end in that
process.
"""

WaitKind = Literal["sample", "event", "delay", "partner", "join"]


@record
class Offer:
    """One of the events that can end a wait, and the place ``target`` where the thread then continues.

    ``channel`` is the path of the net. ``period`` is that of a sampled input, or the length of a delay, 0 if it is
    computed; then ``takes_time`` says whether it is certainly longer than zero. ``key`` is the end at which a sample is
    read; without ``takes`` the sample is only waited for, not taken. ``writes`` is the side of a rendezvous.
    ``is_certain`` is False if the offer depends on a condition, or if it abandons the wait. ``may_follow`` are the
    ends, with their periods, that abandoned branches may have followed.
    """

    uncompared: ClassVar[frozenset[str]] = frozenset()

    kind: WaitKind
    target: int
    span: Span
    channel: str = ""
    period: int = 0
    key: InputEnd = ("", "", 0)
    takes: bool = True
    takes_time: bool = False
    writes: bool = False
    is_certain: bool = True
    may_follow: frozenset[tuple[InputEnd, int]] = frozenset()

    @property
    def end(self) -> tuple[str, bool]:
        """The side of a channel at which it communicates."""
        return self.channel, self.writes


@record
class Move:
    """Values pass from some channels and variables to others, given by the paths of their nets."""

    reads: frozenset[str]
    writes: frozenset[str]


@dataclass(slots=True)
class Place:
    """A node of the control-flow graph: it computes for ``cost`` and continues at one of ``successors``, or waits for
    one of ``offers``; at an end both are empty.

    ``leaf`` is the law or process that computes, ``outputs`` are the nets that it writes to the environment, and
    ``sends`` the channels that it writes without waiting for a reader. ``breaks`` means that another thread may run
    before it continues. ``starts`` is the path of a process that begins here and follows no samples yet. ``may_follow``
    are the ends that parts which begin together follow, although they come one after another here. ``polls`` means that
    it takes an offer only if it is ready, and otherwise continues without one. ``raises`` marks an end by an exception,
    ``halts`` a ``stop``. ``move`` is what it passes on: before a write waits for its reader, and after a read has
    waited for its writer.
    """

    span: Span
    path: str
    cost: int = 0
    leaf: str = ""
    successors: list[int] = field(default_factory=list)
    offers: list[Offer] = field(default_factory=list)
    breaks: bool = False
    starts: str = ""
    may_follow: frozenset[tuple[InputEnd, int]] = frozenset()
    polls: bool = False
    raises: bool = False
    halts: bool = False
    outputs: tuple[str, ...] = ()
    is_by_hand: bool = False
    """Whether nothing is known of what it writes, and when."""
    sends: tuple[str, ...] = ()
    move: Move | None = None

    @property
    def is_idle(self) -> bool:
        """Whether time may pass here whatever other threads do."""
        return any(offer.kind != "partner" for offer in self.offers)

    @property
    def is_end(self) -> bool:
        """Whether nothing comes after it, and no exception was raised."""
        return not self.offers and not self.successors and not self.raises

    @property
    def certain_outputs(self) -> tuple[str, ...]:
        """The outputs that are written whenever it is passed: a fault may come before the write."""
        return () if self.is_by_hand or len(self.successors) > 1 else self.outputs

    @property
    def is_certain_to_move(self) -> bool:
        """Whether it passes on what it has to whenever it is passed: a fault may come before."""
        return self.move is not None and not self.is_by_hand and len(self.successors) <= 1

    def periods(self) -> frozenset[int]:
        """The periods of the samples that are waited for."""
        return frozenset(offer.period for offer in self.offers if offer.kind == "sample")

    def certain_periods(self) -> frozenset[int]:
        """The periods of the samples that end the wait under any condition."""
        return frozenset(offer.period for offer in self.offers if offer.kind == "sample" and offer.is_certain)

    def offers_end(self, channel: str, writes: bool) -> bool:
        """Whether a thread that waits here communicates on that side of a channel under any condition."""
        return any(
            offer.kind == "partner" and offer.is_certain and offer.end == (channel, writes) for offer in self.offers
        )

    def longest_delay(self) -> int | None:
        """The time after which the wait has ended in any case; None if no known time ends it."""
        known = [offer.period for offer in self.offers if offer.kind == "delay" and offer.is_certain and offer.period]
        return min(known, default=None)


@record
class LoopRange:
    """A loop of a thread: the place ``header`` where each iteration begins, and the places from there up to ``end``.

    ``terminates`` says whether the loop is certain to end if nothing in it waits forever; ``iterations`` is their
    number, if it is known but too large for the iterations to be followed one by one.
    """

    header: int
    end: int
    terminates: Callable[[], bool]
    iterations: int | None = None


@dataclass(slots=True)
class Thread:
    """A sequential part of the program.

    ``forks`` are the groups of threads that it starts and waits for, each at the place in ``joins``. ``shared`` are the
    processes, with the periods, whose sampled inputs other threads read as well; ``begins_at_once`` means that the
    program begins with this thread.
    """

    path: str
    priority: tuple[int, ...]
    places: list[Place] = field(default_factory=list)
    entry: int = 0
    forks: list[list[Thread]] = field(default_factory=list)
    joins: list[int] = field(default_factory=list)
    loops: list[LoopRange] = field(default_factory=list)
    shared: frozenset[tuple[str, int]] = frozenset()
    begins_at_once: bool = False
    is_outermost: bool = False

    def with_forks(self) -> Iterator[Thread]:
        """The thread and all threads that it starts."""
        pending = [self]
        while pending:
            thread = pending.pop()
            yield thread
            pending += [inner for group in reversed(thread.forks) for inner in reversed(group)]

    def samples(self) -> frozenset[tuple[InputEnd, int]]:
        """The ends of sampled inputs that the thread itself reads, with their periods."""
        offers = (offer for place in self.places for offer in place.offers)
        return frozenset((offer.key, offer.period) for offer in offers if offer.kind == "sample")

    def first_waits(self) -> set[int]:
        """The waits that it reaches from its beginning."""
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
