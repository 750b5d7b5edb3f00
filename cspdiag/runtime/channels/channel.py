"""The rendezvous channel: one writer and one reader at a time.

Invariants:

- At most one of ``_reader`` and ``_writer`` is set: the party that arrived first and waits. The second party copies the
  value, readies the first and continues.
- The value of a waiting writer is in ``_offered``; the value for a readied reader is in its own ``received``, so a
  further write cannot overwrite it before the reader runs.
- ``scheduler.push`` or ``ready`` comes before any change: in a cancelled task it raises.
- While a party waits, ``_scheduler`` is that of its run. Before, it is that of the run that used the channel last; when
  that run is over it is ``careful``, so a party that has to wait looks up the present one.
"""

from __future__ import annotations

from collections.abc import Generator
from types import coroutine
from typing import TYPE_CHECKING, Any

from ..kernel.exceptions import ChannelMisuse
from ..kernel.party import Party, Waits
from ..kernel.scheduler import Led, no_run, present
from .meeting import Meeting
from .ports import In, Out, T
from .selector import Selector

if TYPE_CHECKING:
    from .alternating import Alternating


class Channel(In[T], Out[T]):
    """A rendezvous: the writer continues only when the reader has taken the value."""

    __slots__ = ("_meeting", "_offered", "_reader", "_scheduler", "_writer", "name")

    def __init__(self, name: str = "channel") -> None:
        self.name = name
        self._reader: Party | None = None
        self._writer: Party | None = None
        self._offered: Any = None
        self._meeting: Meeting | None = None
        self._scheduler = no_run

    @coroutine
    def read(self) -> Generator[None, None, T]:
        """One communication: waits for a value and takes it."""
        writer = self._writer
        scheduler = self._scheduler
        if writer is not None:
            try:
                scheduler.push(writer.entry)
            except Led:
                pass
            else:
                self._writer = None
                if self._meeting is not None:
                    self._meeting.writer_left()
                if scheduler.observe is not None:
                    scheduler.observe(self.name, self._offered, writer, scheduler.current)
                return self._offered  # type: ignore[no-any-return]
        if scheduler.careful:
            scheduler = self._scheduler = present()
            if scheduler.careful:
                return (yield from In.read(self))
        task = scheduler.current
        if self._reader is not None:
            raise ChannelMisuse(f"{self.name} is read by two processes at the same time")
        self._reader = task
        task.waiting = self
        if self._meeting is not None:
            self._meeting.reader_arrived()
        yield
        return task.received  # type: ignore[no-any-return]

    @coroutine
    def write(self, value: T, /) -> Generator[None, None, None]:
        """One communication: continues when the value has been taken."""
        reader = self._reader
        scheduler = self._scheduler
        if reader is not None:
            try:
                scheduler.push(reader.entry)
            except Led:
                pass
            else:
                self._reader = None
                reader.received = value
                if self._meeting is not None:
                    self._meeting.reader_left()
                if scheduler.observe is not None:
                    scheduler.observe(self.name, value, scheduler.current, reader)
                return
        if scheduler.careful:
            scheduler = self._scheduler = present()
            if scheduler.careful:
                yield from Out.write(self, value)
                return
        task = scheduler.current
        if self._writer is not None:
            raise ChannelMisuse(f"{self.name} is written by two processes at the same time")
        self._writer = task
        self._offered = value
        task.waiting = self
        if self._meeting is not None:
            self._meeting.writer_arrived()
        yield

    def request(self, party: Party) -> bool:
        """See ``In.request``."""
        if self._writer is not None:
            party.received = self.take()
            return True
        if self._reader is not None:
            raise ChannelMisuse(f"{self.name} is read by two processes at the same time")
        self._reader = party
        self._scheduler = present()
        if self._meeting is not None:
            self._meeting.reader_arrived()
        return False

    def offer(self, party: Party, value: T, /) -> bool:
        """See ``Out.offer``."""
        if self._reader is not None:
            self._hand_over(self._reader, value)
            return True
        if self._writer is not None:
            raise ChannelMisuse(f"{self.name} is written by two processes at the same time")
        self._writer = party
        self._scheduler = present()
        self._offered = value
        if self._meeting is not None:
            self._meeting.writer_arrived()
        return False

    def withdraw(self, party: Party) -> bool:
        """See ``In.withdraw``."""
        if self._reader is party:
            self._reader = None
            if self._meeting is not None:
                self._meeting.reader_left()
            return True
        if self._writer is party:
            self._writer = None
            if self._meeting is not None:
                self._meeting.writer_left()
            return True
        return False

    def waits_for(self, party: Party) -> Waits:
        """See ``In.waits_for``."""
        return (("to read" if self._reader is party else "to write", self),)

    @property
    def offered(self) -> tuple[Any, Party] | None:
        """The value of the writer that waits, and the writer, if it is none with an output guard."""
        return None if self._writer is None else (self._offered, self._writer)

    def watch_input(self, selector: Selector, bit: int) -> None:
        """See ``In.watch_input``."""
        meeting = self._meeting = self._meeting or Meeting()
        meeting.watch_input(selector, bit, self._writer is not None or bool(meeting.writing))

    def watch_output(self, selector: Selector, bit: int) -> None:
        """See ``Out.watch_output``."""
        meeting = self._meeting = self._meeting or Meeting()
        meeting.watch_output(selector, bit, self._reader is not None or bool(meeting.reading))

    def unwatch_input(self, selector: Selector) -> None:
        """See ``In.unwatch_input``."""
        if self._meeting is not None:
            self._meeting.unwatch(selector)

    unwatch_output = unwatch_input

    def take(self) -> T:
        """See ``In.take``."""
        writer = self._writer
        if writer is None:
            return self._take_from_alternative()
        scheduler = self._scheduler
        scheduler.ready(writer.entry)
        self._writer = None
        if self._meeting is not None:
            self._meeting.writer_left()
        if scheduler.observe is not None:
            scheduler.observe(self.name, self._offered, writer, scheduler.current)
        return self._offered  # type: ignore[no-any-return]

    def _take_from_alternative(self) -> T:
        choice, index = self._alternatives().writing[0]
        value: T = choice.value_offered(index)
        scheduler = present()
        if scheduler.observe is not None:
            scheduler.observe(self.name, value, choice.task, scheduler.current)
        choice.resolve(index, None)
        return value

    def _hand_over(self, reader: Party, value: T) -> None:
        scheduler = self._scheduler
        scheduler.ready(reader.entry)
        self._reader = None
        reader.received = value
        if self._meeting is not None:
            self._meeting.reader_left()
        if scheduler.observe is not None:
            scheduler.observe(self.name, value, scheduler.current, reader)

    def settle_input(self) -> None:
        """An alternative with an output guard here is now committed to it, and parks with its value."""
        if self._writer is None:
            choice, index = self._alternatives().writing[0]
            value = choice.value_offered(index)
            self.offer(choice.pledge(index), value)

    def choose_output(self, party: Party, value: T, /) -> bool:
        """See ``Out.choose_output``."""
        if self._reader is not None:
            self._hand_over(self._reader, value)
            return True
        choice, index = self._alternatives().reading[0]
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
        meeting = self._alternatives()
        meeting.enter(meeting.reading, choice, index)
        meeting.reader_arrived()

    def dismiss_input(self, choice: Alternating) -> None:
        """See ``In.dismiss_input``."""
        meeting = self._alternatives()
        meeting.reading = [entry for entry in meeting.reading if entry[0] is not choice]
        if self._reader is None and not meeting.reading:
            meeting.reader_left()

    def enroll_output(self, choice: Alternating, index: int) -> None:
        """See ``Out.enroll_output``."""
        meeting = self._alternatives()
        meeting.enter(meeting.writing, choice, index)
        meeting.writer_arrived()

    def dismiss_output(self, choice: Alternating) -> None:
        """See ``Out.dismiss_output``."""
        meeting = self._alternatives()
        meeting.writing = [entry for entry in meeting.writing if entry[0] is not choice]
        if self._writer is None and not meeting.writing:
            meeting.writer_left()

    def _alternatives(self) -> Meeting:
        assert self._meeting is not None
        return self._meeting
