"""The control flow of each thread of a program: where it computes, where it waits and for what.

A thread is what the scheduler switches between: the outermost process, and every branch of a parallel that has a loop in it. The branches of a
parallel without loops are work of the thread that starts them, one after another, since one processor runs them so.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Literal

from cspdiag.diagnostics import Span

WaitKind = Literal["sample", "event", "delay", "partner", "join"]


@dataclass(frozen=True, slots=True)
class Offer:
    """What a waiting thread goes on with.

    ``channel`` is the path of the net; ``period`` that of a sampled input, or the shortest duration of a delay; ``key`` tells apart who keeps books of the
    samples of an input, and without ``takes`` a sample is only looked for; ``writes`` tells the side of a rendezvous;
    ``groups`` are the parallels whose branches are work of one thread, around it.
    """

    kind: WaitKind
    target: int
    span: Span
    channel: str = ""
    period: int = 0
    key: tuple[str, str, int] = ("", "", 0)
    takes: bool = True
    writes: bool = False
    groups: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Move:
    """Values pass from some channels and variables to others, by the paths of their nets."""

    reads: frozenset[str]
    writes: frozenset[str]


@dataclass(slots=True)
class Place:
    """A point of a thread: it computes for ``cost`` and goes on to one of ``successors``, or waits for one of ``offers``; an end has neither.

    ``leaf`` is the law or process that computes, ``outputs`` are the nets that it writes to the outside. ``breaks`` tells that another thread may run before it goes on.
    ``starts`` is the path of a process that begins here, without samples of its own yet. ``gives`` are the channels that it writes without ever waiting for who reads them. ``move`` is what it
    hands on, of a write before who reads is waited for, of a read after who writes was.
    """

    span: Span
    path: str
    cost: int = 0
    leaf: str = ""
    successors: list[int] = field(default_factory=list)
    offers: list[Offer] = field(default_factory=list)
    breaks: bool = False
    starts: str = ""
    outputs: tuple[str, ...] = ()
    gives: tuple[str, ...] = ()
    move: Move | None = None

    @property
    def is_idle(self) -> bool:
        """Whether time may pass here whatever other threads do."""
        return any(offer.kind != "partner" for offer in self.offers)


@dataclass(slots=True)
class Thread:
    """A sequential part of the program. ``forks`` are the groups of threads that it starts and waits for."""

    path: str
    priority: tuple[int, ...]
    places: list[Place] = field(default_factory=list)
    entry: int = 0
    forks: list[list[Thread]] = field(default_factory=list)

    def with_forks(self) -> Iterator[Thread]:
        """The thread and all that it starts."""
        pending = [self]
        while pending:
            thread = pending.pop()
            yield thread
            pending += [inner for group in reversed(thread.forks) for inner in reversed(group)]

    def has_samples(self) -> bool:
        """Whether the thread follows a sample period."""
        return any(offer.kind == "sample" for place in self.places for offer in place.offers)


@dataclass(frozen=True, slots=True)
class Missing:
    """A law or process that does not say its worst-case execution time; ``span`` is its definition."""

    leaf: str
    definition: str
    kind: Literal["submodel", "process"]
    span: Span
