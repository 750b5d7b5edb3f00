"""The ends of a channel between places.

The channel exists in both places. In that of its writer a ``SendingEnd`` reads from it on behalf of the readers
elsewhere: it offers the value to them, and takes it when they have taken it, so the writer waits for that long. In a
place of readers a ``ReceivingEnd`` writes to it on behalf of the writer.

Each offer gets one answer: it was taken, or it was returned. A writer that waits no longer withdraws its offer, and
nothing else is offered before the answer. So of writers that gave up at most one can have its value taken
nevertheless: that whose answer was on the way, or lost, then.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, NamedTuple, TypeAlias

from cspdiag.runtime.channels.broadcast import Broadcast, BroadcastEnd
from cspdiag.runtime.channels.channel import Channel
from cspdiag.runtime.channels.selector import Selector
from cspdiag.runtime.kernel.executed import Executed
from cspdiag.runtime.kernel.party import Entry, ReadyQueue
from cspdiag.runtime.kernel.scheduler import Scheduler

Doing: TypeAlias = Literal["offer", "withdraw", "taken", "returned"]


class Item(NamedTuple):
    """What one end of a channel sends to the other: the value is offered by a writer, withdrawn, was taken, or returns
    without having been taken. ``number`` counts the offers.
    """

    doing: Doing
    channel: str
    number: int
    value: Any = None
    writer: str = ""


Send: TypeAlias = Callable[[str, Item], None]
"""Sends an item to a place."""


class _Arrivals(Selector):
    """The part of a guard on the channel: counts the writers that begin to wait."""

    __slots__ = ("count",)

    def __init__(self) -> None:
        super().__init__()
        self.armed = 1
        self.count = 0

    def wake(self) -> None:
        """A writer waits."""
        self.count += 1


class SendingEnd:
    """The end of the readers in ``place``, in the place of the writer."""

    def __init__(self, end: Channel[Any] | BroadcastEnd[Any], place: str, send: Send) -> None:
        self.end = end
        self.place = place
        self._send = send
        self._arrivals = _Arrivals()
        self._number = 0
        self._offered = 0
        """Which arrival was offered and neither answered nor withdrawn; 0: none."""
        self._answered = 0
        """The number of the last offer that was answered."""
        end.watch_input(self._arrivals, 1)

    @property
    def waits(self) -> bool:
        """Whether a writer waits for the readers."""
        return bool(self._arrivals.ready)

    def step(self) -> None:
        """Tells what has changed since the last step."""
        waits = self._arrivals.ready
        if self._offered and (not waits or self._offered != self._arrivals.count):
            self._offered = 0
            self._send(self.place, Item("withdraw", self.end.name, self._number))
        if waits and self._answered == self._number:
            offered = self.end.offered
            assert offered is not None
            value, writer = offered
            self._offered = self._arrivals.count
            self._number += 1
            name = "" if writer.process is None else writer.process.name
            self._send(self.place, Item("offer", self.end.name, self._number, value, name))

    def taken(self, number: int) -> None:
        """The readers have taken a value; the writer continues, if it has not been withdrawn in the meantime."""
        was_offered = self._offered == self._arrivals.count and self._arrivals.ready
        self.returned(number)
        if was_offered:
            self.end.take()

    def returned(self, number: int) -> None:
        """A value was not taken. If its writer still waits, it is offered again."""
        self._answered = number
        self._offered = 0


class ReceivingEnd:
    """The end of the writer in ``place``, in a place of readers: a party that waits like the writer."""

    def __init__(self, channel: Channel[Any] | Broadcast[Any], place: str, scheduler: Scheduler, send: Send) -> None:
        self.received: Any = None
        self.process: Executed | None = None
        self._channel = channel
        self.place = place
        self._scheduler = scheduler
        self._send = send
        self._number = 0
        self._waits = False

    @property
    def ready_queue(self) -> ReadyQueue:
        """See ``Party.ready_queue``."""
        return self._scheduler.queue

    @property
    def entry(self) -> Entry:
        """See ``Party.entry``."""
        return self

    def __next__(self) -> object:
        """See ``Party``."""
        self.resume(None)
        return None

    def resume(self, _: None) -> None:
        """The value was taken."""
        self._waits = False
        self._send(self.place, Item("taken", self._channel.name, self._number))

    def offer(self, number: int, value: Any, writer: str) -> None:
        """The writer waits."""
        self._number = number
        self.process = _Writer(writer)
        self._scheduler.current = self  # type: ignore[assignment]
        try:
            self._waits = not self._channel.offer(self, value)
        finally:
            self._scheduler.current = None  # type: ignore[assignment]
        if not self._waits:
            self.resume(None)

    def withdraw(self, number: int) -> None:
        """The writer waits no longer; nothing happens if its value was taken before."""
        if number > self._number:
            self._number = number  # Its offer has not arrived.
            self._return()
        elif self._waits and self._channel.withdraw(self):
            self._return()

    def hand_back(self) -> None:
        """Returns the value, unless a reader, of several, has taken it."""
        if self._waits and not self._is_taken_in_part and self._channel.withdraw(self):
            self._return()

    @property
    def _is_taken_in_part(self) -> bool:
        return isinstance(self._channel, Broadcast) and not all(end.fresh for end in self._channel.ends)

    def _return(self) -> None:
        self._waits = False
        self._send(self.place, Item("returned", self._channel.name, self._number))


class _Writer(Executed):
    """The writer in the other place, by its path."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.source = None
