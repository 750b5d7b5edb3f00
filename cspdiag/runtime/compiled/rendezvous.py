"""Rendezvous channels for optimized code, which accesses their slots directly.

Invariants:

- At most one party waits: the one that arrived first. What removes it puts it into the ready queue. In a
  ``Rendezvous`` it is ``reading`` or ``writing``; in a ``Dedicated`` channel it is the ``reader`` if ``value`` is None,
  and the ``writer`` if ``offered`` is not None.
- ``offered`` is the value of the waiting writer, ``value`` what was handed over to the reader that waited. There are
  two places because the next writer may offer before the reader that was readied has run.
"""

from __future__ import annotations

from typing import Any, Final

from ..channels.ports import In, Out, T
from ..channels.selector import Selector, Watchers, lower_bits, raise_bits, without
from ..kernel.party import Party, Waits
from ..kernel.scheduler import present
from .numbered import Names, name_of

_NOTHING: Final[Any] = object()
"""The ``value`` of a dedicated channel whose reader does not wait, and has not been given a value either."""


class Slots(In[T], Out[T]):
    """A rendezvous of one writer and one reader at a time. ``label`` is its name, or the names of the array that it is
    an element of.
    """

    __slots__ = ("label",)

    def __init__(self, name: str = "channel") -> None:
        self.label: str | Names = name

    @property
    def name(self) -> str:  # type: ignore[override]
        """Its path from the outermost process."""
        return name_of(self)

    def holds(self, party: Party) -> bool:
        """Whether a party waits here."""
        raise NotImplementedError


class Dedicated(Slots[T]):
    """For optimized code alone, each end of which belongs to one task, ``reader`` and ``writer``, which it notes before
    it waits for the first time. None is no value of it.
    """

    __slots__ = ("offered", "reader", "value", "writer")

    def __init__(self, name: str = "channel") -> None:
        super().__init__(name)
        self.reader: Any = None
        self.writer: Any = None
        self.offered: Any = None
        self.value: Any = _NOTHING

    def holds(self, party: Party) -> bool:
        """See ``Slots.holds``."""
        return self._holds_reader(party) or (self.offered is not None and self.writer is party)

    def _holds_reader(self, party: Party) -> bool:
        return self.value is None and self.reader is party

    def withdraw(self, party: Party) -> bool:
        """See ``In.withdraw``."""
        if not self.holds(party):
            return False
        if self._holds_reader(party):
            self.value = _NOTHING
        else:
            self.offered = None
        return True

    def waits_for(self, party: Party) -> Waits:
        """See ``In.waits_for``."""
        return (("to read" if self._holds_reader(party) else "to write", self),)


class Rendezvous(Slots[T]):
    """Like ``Channel``, for a writer and a reader that do not alternate. The methods are for parties that are not
    optimized code.
    """

    __slots__ = ("offered", "reading", "value", "writing")

    def __init__(self, name: str = "channel") -> None:
        super().__init__(name)
        self.reading: Any = None
        self.writing: Any = None
        self.offered: Any = None
        self.value: Any = None

    def holds(self, party: Party) -> bool:
        """See ``Slots.holds``."""
        return party in (self.reading, self.writing)

    def request(self, party: Party) -> bool:
        """See ``In.request``."""
        if self.writing is not None:
            party.received = self.take()
            return True
        self.reading = party
        return False

    def collect(self, party: Party) -> bool:
        """See ``In.collect``: the value was handed over."""
        party.received = self.value
        return True

    def offer(self, party: Party, value: T, /) -> bool:
        """See ``Out.offer``."""
        reader = self.reading
        if reader is None:
            self.writing = party
            self.offered = value
            return False
        scheduler = present()
        scheduler.ready(reader.entry)
        self.reading = None
        self.value = value
        if scheduler.observe is not None:
            scheduler.observe(self.name, value, scheduler.current, reader)
        return True

    def take(self) -> T:
        """See ``In.take``."""
        writer = self.writing
        assert writer is not None
        scheduler = present()
        scheduler.ready(writer.entry)
        self.writing = None
        if scheduler.observe is not None:
            scheduler.observe(self.name, self.offered, writer, scheduler.current)
        return self.offered  # type: ignore[no-any-return]

    def withdraw(self, party: Party) -> bool:
        """See ``In.withdraw``."""
        if self.reading is party:
            self.reading = None
            return True
        if self.writing is party:
            self.writing = None
            return True
        return False

    def waits_for(self, party: Party) -> Waits:
        """See ``In.waits_for``."""
        return (("to read" if self.reading is party else "to write", self),)


class Alternated(Rendezvous[T]):
    """A rendezvous whose reader may alternate.

    A writer that begins to wait with a value sets ``bit`` in ``selector.ready``, and wakes the selector if that has
    ``bit`` armed; what takes the value calls ``lower``. With several alternatives on the channel the selector is a
    ``Fan``.
    """

    __slots__ = ("_watchers", "bit", "selector")

    def __init__(self, name: str = "channel") -> None:
        super().__init__(name)
        self._watchers: Watchers = ()
        self.selector: Selector = Fan()
        self.bit = 1

    def offer(self, party: Party, value: T, /) -> bool:
        """See ``Out.offer``."""
        done = super().offer(party, value)
        if not done:
            raise_bits(self._watchers)
        return done

    def take(self) -> T:
        """See ``In.take``."""
        value = super().take()
        self.lower()
        return value

    def lower(self) -> None:
        """The writer no longer waits."""
        lower_bits(self._watchers)

    def withdraw(self, party: Party) -> bool:
        """See ``In.withdraw``."""
        if self.writing is party:
            self.lower()
        return super().withdraw(party)

    def watch_input(self, selector: Selector, bit: int) -> None:
        """See ``In.watch_input``."""
        self._watched((*self._watchers, (selector, bit)))
        if self.writing is not None:
            selector.ready |= bit

    def unwatch_input(self, selector: Selector) -> None:
        """See ``In.unwatch_input``."""
        self._watched(without(self._watchers, selector))

    def _watched(self, watchers: Watchers) -> None:
        self._watchers = watchers
        if len(watchers) == 1:
            ((self.selector, self.bit),) = watchers
        else:
            self.selector, self.bit = Fan(watchers), 1


class Fan(Selector):
    """Represents the selectors of several alternatives, or of none, on one channel: it is woken every time, and wakes
    them.
    """

    __slots__ = ("_watchers",)

    def __init__(self, watchers: Watchers = ()) -> None:
        super().__init__()
        self.armed = -1
        self._watchers = watchers

    def wake(self) -> None:
        """A writer has arrived."""
        raise_bits(self._watchers)
