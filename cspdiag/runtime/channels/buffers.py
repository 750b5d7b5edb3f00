"""Channels with memory between one writer and one reader.

Invariant: while the reader waits, nothing is stored; while the writer waits, the buffer is full.
"""

from __future__ import annotations

from collections import deque
from typing import Any

from ..kernel.exceptions import ChannelMisuse
from ..kernel.party import Party, Waits
from ..kernel.scheduler import present
from .ports import In, Out, T
from .selector import Selector, Watchers, lower_bits, raise_bits, without


class Buffer(In[T], Out[T]):
    """A FIFO of ``capacity`` values: the writer waits while it is full. It communicates when a value enters."""

    __slots__ = ("_inputs", "_offered", "_outputs", "_reader", "_stored", "_writer", "capacity", "name")

    def __init__(self, name: str = "buffer", capacity: int = 1) -> None:
        if capacity < 1:
            raise ValueError(f"{name}: a buffer holds at least one value, not {capacity}")
        self.name = name
        self.capacity = capacity
        self._stored: deque[T] = deque()
        self._reader: Party | None = None
        self._writer: Party | None = None
        self._offered: Any = None
        self._inputs: Watchers = ()
        self._outputs: Watchers = ()

    def request(self, party: Party) -> bool:
        """See ``In.request``."""
        if self._stored:
            party.received = self.take()
            return True
        if self._reader is not None:
            raise ChannelMisuse(f"{self.name} is read by two processes at the same time")
        self._reader = party
        return False

    def offer(self, party: Party, value: T, /) -> bool:
        """See ``Out.offer``."""
        if self._reader is None and len(self._stored) == self.capacity:
            return self._offer_when_full(party, value)
        self._enter(value, party)
        return True

    def _offer_when_full(self, party: Party, value: T) -> bool:
        if self._writer is not None:
            raise ChannelMisuse(f"{self.name} is written by two processes at the same time")
        self._writer = party
        self._offered = value
        return False

    def _enter(self, value: T, writer: Party) -> None:
        scheduler = present()
        reader = self._reader
        if reader is not None:
            scheduler.ready(reader.entry)
            reader.received = value
            self._reader = None
        else:
            self._stored.append(value)
            raise_bits(self._inputs)
            if len(self._stored) == self.capacity:
                lower_bits(self._outputs)
        if scheduler.observe is not None:
            scheduler.observe(self.name, value, writer, None)
        if scheduler.policy is not None and reader is not None:
            scheduler.policy.took_part(reader, "read", self.name)

    def withdraw(self, party: Party) -> bool:
        """See ``In.withdraw``."""
        if self._reader is party:
            self._reader = None
            return True
        if self._writer is party:
            self._writer = None
            return True
        return False

    def waits_for(self, party: Party) -> Waits:
        """See ``In.waits_for``."""
        return (("to read" if self._reader is party else "to write", self),)

    def take(self) -> T:
        """See ``In.take``."""
        scheduler = present()
        if scheduler.policy is not None:
            scheduler.policy.took_part(scheduler.current, "read", self.name)
        value = self._stored.popleft()
        if self._writer is not None:
            writer, self._writer = self._writer, None
            writer.ready_queue.append(writer.entry)
            self._enter(self._offered, writer)
        else:
            raise_bits(self._outputs)
        if not self._stored:
            lower_bits(self._inputs)
        return value

    def watch_input(self, selector: Selector, bit: int) -> None:
        """See ``In.watch_input``."""
        self._inputs = (*self._inputs, (selector, bit))
        if self._stored:
            selector.ready |= bit

    def unwatch_input(self, selector: Selector) -> None:
        """See ``In.unwatch_input``."""
        self._inputs = without(self._inputs, selector)

    def watch_output(self, selector: Selector, bit: int) -> None:
        """See ``Out.watch_output``."""
        self._outputs = (*self._outputs, (selector, bit))
        if len(self._stored) < self.capacity:
            selector.ready |= bit

    def unwatch_output(self, selector: Selector) -> None:
        """See ``Out.unwatch_output``."""
        self._outputs = without(self._outputs, selector)


class Overwriting(Buffer[T]):
    """A FIFO of ``capacity`` values that drops the oldest: the writer never waits."""

    __slots__ = ()

    def _offer_when_full(self, party: Party, value: T) -> bool:
        self._stored.popleft()
        self._enter(value, party)
        return True

    def watch_output(self, selector: Selector, bit: int) -> None:
        """See ``Out.watch_output``: always ready."""
        selector.ready |= bit
