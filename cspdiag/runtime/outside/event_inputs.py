"""Event inputs of the outermost process: the latest value that its environment has offered is kept until it is read.

It communicates when a reader takes it.
"""

from __future__ import annotations

from collections import deque
from typing import Any, Literal

from ..channels.latched import LatchedEnd, refuse_cancelled
from ..channels.ports import In, Owner, T
from ..channels.selector import raise_bits
from ..kernel.party import Party
from ..kernel.scheduler import present
from .accepted import Accept
from .drivers import Driver
from .supply import Supply


class EventEnd(LatchedEnd[T]):
    """A latch of an event input; ``owner`` is the path of its only reader, "" if all readers share it."""

    __slots__ = ("_readers", "owner")

    def __init__(self, name: str, owner: str = "") -> None:
        super().__init__(name)
        self.owner = owner
        self._readers: deque[Party] = deque()

    @property
    def awaited(self) -> bool:
        """Whether a reader waits for an event."""
        return bool(self._readers) or self.alternative_waits()

    def occur(self, value: T) -> None:
        """The environment offers a new value."""
        self.value = value
        self.fresh = True
        if self._readers:
            reader = self._readers.popleft()
            reader.ready_queue.append(reader.entry)
        raise_bits(self.inputs)

    def taken(self, reader: Party) -> T:
        """See ``LatchedEnd.taken``."""
        scheduler = present()
        if scheduler.port_logs:
            scheduler.note(self.name, self.value)
        return super().taken(reader)

    def request(self, party: Party) -> bool:
        """See ``In.request``."""
        if self.fresh:
            party.received = self.taken(party)
            return True
        self._readers.append(party)
        return False

    def collect(self, party: Party) -> bool:
        """See ``In.collect``."""
        if present().current.cancelled and self.fresh and self._readers:
            reader = self._readers.popleft()
            reader.ready_queue.append(reader.entry)
        refuse_cancelled()
        if self.fresh:
            party.received = self.taken(party)
            return True
        self._readers.appendleft(party)
        return False

    def withdraw(self, party: Party) -> bool:
        """See ``In.withdraw``."""
        if party not in self._readers:
            return False
        self._readers.remove(party)
        return True


class EventInput(In[T]):
    """An event input of the outermost process.

    With ``kind="broadcast"`` every reading end has a latch of its own; otherwise all readers share one, and a value
    goes to one of them.
    """

    __slots__ = ("accepts", "driver", "ends", "kind", "last", "line", "name", "polled")

    def __init__(
        self,
        name: str,
        *,
        driver: Driver | None = None,
        kind: Literal["sync", "any", "broadcast"] = "sync",
        accepts: Accept | None = None,
    ) -> None:
        self.name = name
        self.accepts = accepts
        self.driver = driver
        self.line: Any = driver
        self.polled = driver is not None
        self.kind = kind
        self.ends: list[EventEnd[T]] = [] if kind == "broadcast" else [EventEnd(name)]
        self.last: Any = None
        """The value at the last instant of the grid."""

    def reader(self, owner: Owner | None = None) -> EventEnd[T]:
        """The end of a process."""
        if isinstance(self.driver, Supply):
            supplied: Any = self.driver.end_of(self.name)
            return supplied  # type: ignore[no-any-return]
        if self.kind == "broadcast":
            self.ends.append(EventEnd(self.name, "" if owner is None else owner.name))
        return self.ends[-1]

    def end_of(self, path: str) -> EventEnd[T]:
        """The end of a process, or of the innermost process around it that has one."""
        fitting = [end for end in self.ends if f"{path}.".startswith(f"{end.owner}." if end.owner else "")]
        return max(fitting, key=lambda end: len(end.owner), default=self.ends[-1])

    def start(self) -> None:
        """Notes the value at the beginning, which is not an event."""
        self.last = self.line.read()

    def poll(self) -> None:
        """A grid instant: offers the value if it has changed."""
        value = self.line.read()
        if value != self.last:
            self.last = value
            self.occur(value)

    def occur(self, value: T) -> None:
        """The environment offers a new value."""
        for end in self.ends:
            end.occur(value)

    @property
    def can_have_effect(self) -> bool:
        """Whether an event can make a process ready: a reader waits for it."""
        if self.driver is None:
            return False
        for end in self.ends:  # noqa: SIM110 - asked at every instant, and a generator takes three times as long
            if end.awaited:
                return True
        return False
