"""The broadcast channel: every reading end gets every value.

Invariants: an end is *fresh* from the write until its reader has taken the value; the writer waits while any end is
fresh.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..kernel.exceptions import ChannelMisuse
from ..kernel.party import Party, Waits
from ..kernel.scheduler import present
from .ports import In, Out, Owner, T
from .selector import Selector, Watchers, attend, lower_bits, raise_bits, without

if TYPE_CHECKING:
    from .alternating import Alternating


class Broadcast(In[T], Out[T]):
    """One writer, and a reader for each end made by ``reader``; the writer continues when all have taken the value.

    ``ends`` are the reading ends; while a ``writer`` waits, ``value`` is what it writes.
    """

    __slots__ = ("_outputs", "ends", "name", "value", "writer")

    def __init__(self, name: str = "broadcast") -> None:
        self.name = name
        self.ends: list[BroadcastEnd[T]] = []
        self.writer: Party | None = None
        self.value: Any = None
        self._outputs: Watchers = ()

    def reader(self, owner: Owner | None = None) -> BroadcastEnd[T]:
        """A new reading end."""
        end = BroadcastEnd(self, "" if owner is None else owner.name)
        self.ends.append(end)
        self.readers_changed()
        return end if owner is None else owner.owns(end)

    def offer(self, party: Party, value: T, /) -> bool:
        """See ``Out.offer``."""
        if self.writer is not None:
            raise ChannelMisuse(f"{self.name} is written by two processes at the same time")
        policy = present().policy
        if policy is not None:
            policy.took_part(party, "write", self.name)
        self.writer = party
        self.value = value
        for end in self.ends:
            end.receive(value)
        if any(end.fresh for end in self.ends):
            return False
        self.writer = None
        return True

    def choose_output(self, party: Party, value: T, /) -> bool:
        """See ``Out.choose_output``."""
        for end in self.ends:
            if end.waiting_choice is not None:
                choice, index = end.waiting_choice
                if choice.only_promises(index):
                    choice.resolve(index, None)
                else:
                    choice.resolve(index, value)
                    end.resolved = True
                    scheduler = present()
                    if scheduler.observe is not None:
                        scheduler.observe(self.name, value, scheduler.current, choice.task)
        return self.offer(party, value)

    def withdraw(self, party: Party) -> bool:
        """See ``Out.withdraw``: a reader that has not taken the value yet does not get it."""
        if self.writer is not party:
            return False
        self.writer = None
        for end in self.ends:
            end.recall()
        return True

    def waits_for(self, party: Party) -> Waits:
        """See ``Out.waits_for``."""
        return (("to write", self),)

    @property
    def missing(self) -> list[BroadcastEnd[T]]:
        """The ends that its writer waits for: those that have not taken the value, or, before an output guard is
        chosen, those at which no reader waits.
        """
        if self.writer is None:
            return [end for end in self.ends if not end.awaited]
        return [end for end in self.ends if end.fresh]

    def taken(self, end: BroadcastEnd[T], reader: Party) -> T:
        """Takes the value of an end, which is then no longer fresh; the last one readies the writer."""
        writer = self.writer
        assert writer is not None
        scheduler = present()
        if not any(other.fresh for other in self.ends if other is not end):
            scheduler.ready(writer.entry)
            self.writer = None
        end.recall()
        if scheduler.observe is not None:
            scheduler.observe(self.name, self.value, writer, reader)
        return self.value  # type: ignore[no-any-return]

    @property
    def has_output_guards(self) -> bool:
        """Whether an alternative may write here."""
        return bool(self._outputs)

    def readers_changed(self) -> None:
        """An output guard is ready while all readers wait."""
        if self._outputs:
            if all(end.awaited for end in self.ends):
                raise_bits(self._outputs)
            else:
                lower_bits(self._outputs)

    def watch_output(self, selector: Selector, bit: int) -> None:
        """See ``Out.watch_output``."""
        self._outputs = (*self._outputs, (selector, bit))
        for end in self.ends:
            end.attend()
        self.readers_changed()

    def unwatch_output(self, selector: Selector) -> None:
        """See ``Out.unwatch_output``."""
        self._outputs = without(self._outputs, selector)


class BroadcastEnd(In[T]):
    """A reading end of a broadcast; ``fresh`` while it has a value that has not been taken.

    ``owner`` is the path of the process that reads from it, "" if unknown; ``closed`` is whether that process has ended
    at least once.
    """

    __slots__ = ("_inputs", "_reader", "channel", "closed", "fresh", "name", "owner", "resolved", "waiting_choice")

    def __init__(self, channel: Broadcast[T], owner: str = "") -> None:
        self.name = channel.name
        self.owner = owner
        self.closed = False
        self.fresh = False
        self.resolved = False
        self.waiting_choice: tuple[Alternating, int] | None = None
        self.channel = channel
        self._reader: Party | None = None
        self._inputs: Watchers = ()

    @property
    def awaited(self) -> bool:
        """Whether its reader is waiting."""
        return self._reader is not None or self.waiting_choice is not None

    def close(self) -> None:
        """See ``In.close``."""
        self.closed = True

    def receive(self, value: T) -> None:
        """A value was written: hands it to the reader that waits, or keeps it."""
        if self.resolved:
            self.resolved = False
        elif self._reader is not None:
            reader, self._reader = self._reader, None
            reader.ready_queue.append(reader.entry)
            reader.received = value
            self.channel.readers_changed()
            scheduler = present()
            if scheduler.observe is not None:
                scheduler.observe(self.name, value, scheduler.current, reader)
        else:
            self.fresh = True
            raise_bits(self._inputs)

    def recall(self) -> None:
        """The value is withdrawn."""
        self.fresh = False
        lower_bits(self._inputs)

    def request(self, party: Party) -> bool:
        """See ``In.request``."""
        if self.fresh:
            party.received = self.channel.taken(self, party)
            return True
        if self._reader is not None:
            raise ChannelMisuse(f"one end of {self.name} is read by two processes at the same time")
        self._reader = party
        self.channel.readers_changed()
        return False

    def withdraw(self, party: Party) -> bool:
        """See ``In.withdraw``."""
        if self._reader is not party:
            return False
        self._reader = None
        self.channel.readers_changed()
        return True

    def take(self) -> T:
        """See ``In.take``."""
        return self.channel.taken(self, present().current)

    def watch_input(self, selector: Selector, bit: int) -> None:
        """See ``In.watch_input``."""
        self._inputs = (*self._inputs, (selector, bit))
        if self.fresh:
            selector.ready |= bit
        if self.channel.has_output_guards:
            selector.attend |= bit

    @property
    def offered(self) -> tuple[Any, Party] | None:
        """The value that has not been taken here yet, and its writer."""
        writer = self.channel.writer
        return (self.channel.value, writer) if self.fresh and writer is not None else None

    def attend(self) -> None:
        """From now on, output guards are notified when alternatives wait here."""
        attend(self._inputs)

    def unwatch_input(self, selector: Selector) -> None:
        """See ``In.unwatch_input``."""
        self._inputs = without(self._inputs, selector)

    def enroll_input(self, choice: Alternating, index: int) -> None:
        """See ``In.enroll_input``."""
        self.waiting_choice = (choice, index)
        self.channel.readers_changed()

    def dismiss_input(self, choice: Alternating) -> None:
        """See ``In.dismiss_input``."""
        self.waiting_choice = None
        self.channel.readers_changed()
