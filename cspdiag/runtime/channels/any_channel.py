"""The rendezvous channel with many writers and many readers: each communication is between one of each.

Invariants: at most one of the two queues of waiting parties is not empty; parties are served first come, first served.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from ..kernel.party import Party, Waits
from ..kernel.scheduler import present
from .meeting import Meeting
from .ports import In, Out, T
from .selector import Selector

if TYPE_CHECKING:
    from .alternating import Alternating


class AnyChannel(In[T], Out[T]):
    """A rendezvous of any of several writers with any of several readers."""

    __slots__ = ("_meeting", "_readers", "_writers", "name")

    def __init__(self, name: str = "channel") -> None:
        self.name = name
        self._readers: deque[Party] = deque()
        self._writers: deque[tuple[Party, T]] = deque()
        self._meeting = Meeting()

    def request(self, party: Party) -> bool:
        """See ``In.request``."""
        if self._writers:
            party.received = self.take()
            return True
        self._readers.append(party)
        self._meeting.reader_arrived()
        return False

    def offer(self, party: Party, value: T, /) -> bool:
        """See ``Out.offer``."""
        if self._readers:
            self._hand_over(value)
            return True
        self._writers.append((party, value))
        self._meeting.writer_arrived()
        return False

    def withdraw(self, party: Party) -> bool:
        """See ``In.withdraw``."""
        waiting = len(self._readers) + len(self._writers)
        self._readers = deque(entry for entry in self._readers if entry is not party)
        self._writers = deque(entry for entry in self._writers if entry[0] is not party)
        self._partner_left()
        return len(self._readers) + len(self._writers) < waiting

    def waits_for(self, party: Party) -> Waits:
        """See ``In.waits_for``."""
        return (("to read" if party in self._readers else "to write", self),)

    def watch_input(self, selector: Selector, bit: int) -> None:
        """See ``In.watch_input``."""
        self._meeting.watch_input(selector, bit, bool(self._writers or self._meeting.writing))

    def watch_output(self, selector: Selector, bit: int) -> None:
        """See ``Out.watch_output``."""
        self._meeting.watch_output(selector, bit, bool(self._readers or self._meeting.reading))

    def unwatch_input(self, selector: Selector) -> None:
        """See ``In.unwatch_input``."""
        self._meeting.unwatch(selector)

    unwatch_output = unwatch_input

    def take(self) -> T:
        """See ``In.take``."""
        scheduler = present()
        if self._writers:
            writer, value = self._writers[0]
            scheduler.ready(writer.entry)
            self._writers.popleft()
            self._partner_left()
        else:
            choice, index = self._meeting.writing[0]
            writer, value = choice.task, choice.value_offered(index)
            choice.resolve(index, None)
        if scheduler.observe is not None:
            scheduler.observe(self.name, value, writer, scheduler.current)
        return value

    def _hand_over(self, value: T) -> None:
        scheduler = present()
        reader = self._readers[0]
        scheduler.ready(reader.entry)
        self._readers.popleft()
        reader.received = value
        self._partner_left()
        if scheduler.observe is not None:
            scheduler.observe(self.name, value, scheduler.current, reader)

    def settle_input(self) -> None:
        """An alternative with an output guard here is now committed to it: it parks with its value, or hands it to a
        reader that waits already.
        """
        if self._writers:
            return
        choice, index = self._meeting.writing[0]
        value = choice.value_offered(index)
        if not self._readers:
            self.offer(choice.pledge(index), value)
            return
        choice.resolve(index, None)
        reader = self._readers.popleft()
        reader.received = value
        reader.ready_queue.append(reader.entry)
        self._partner_left()
        scheduler = present()
        if scheduler.observe is not None:
            scheduler.observe(self.name, value, choice.task, reader)

    def choose_output(self, party: Party, value: T, /) -> bool:
        """See ``Out.choose_output``."""
        if self._readers:
            self._hand_over(value)
            return True
        choice, index = self._meeting.reading[0]
        if choice.only_promises(index):
            choice.resolve(index, None)
            return self.offer(party, value)
        scheduler = present()
        if scheduler.observe is not None:
            scheduler.observe(self.name, value, scheduler.current, choice.task)
        choice.resolve(index, value)
        return True

    def enroll_input(self, choice: Alternating, index: int) -> None:
        """See ``In.enroll_input``."""
        Meeting.enter(self._meeting.reading, choice, index)
        self._meeting.reader_arrived()

    def dismiss_input(self, choice: Alternating) -> None:
        """See ``In.dismiss_input``."""
        self._meeting.reading = [entry for entry in self._meeting.reading if entry[0] is not choice]
        self._partner_left()

    def enroll_output(self, choice: Alternating, index: int) -> None:
        """See ``Out.enroll_output``."""
        Meeting.enter(self._meeting.writing, choice, index)
        self._meeting.writer_arrived()

    def dismiss_output(self, choice: Alternating) -> None:
        """See ``Out.dismiss_output``."""
        self._meeting.writing = [entry for entry in self._meeting.writing if entry[0] is not choice]
        self._partner_left()

    def _partner_left(self) -> None:
        if not self._writers and not self._meeting.writing:
            self._meeting.writer_left()
        if not self._readers and not self._meeting.reading:
            self._meeting.reader_left()
