"""An end that keeps the latest value from outside until it is taken."""

from __future__ import annotations

from typing import Any

from .exceptions import Cancelled
from .ports import In, T
from .scheduler import Party, scheduler
from .selector import Selector, Watchers, lower_bits, without


class LatchedEnd(In[T]):
    """An end that keeps the latest value until it is taken: *fresh* until then."""

    __slots__ = ("_fresh", "_inputs", "_value", "name")

    def __init__(self, name: str) -> None:
        self.name = name
        self._fresh = False
        self._value: Any = None
        self._inputs: Watchers = ()

    @property
    def collectable(self) -> bool:
        """See ``In.collectable``."""
        return self._fresh

    def take(self) -> T:
        """See ``In.take``."""
        return self._taken(scheduler.current)

    def _taken(self, reader: Party) -> T:
        """The value, which ``reader`` takes."""
        return self._communicated(reader)

    def _communicated(self, reader: Party) -> T:
        self._fresh = False
        if self._inputs:
            lower_bits(self._inputs)
        if scheduler.observe is not None:
            scheduler.observe(self.name, self._value, None, reader)
        return self._value  # type: ignore[no-any-return]

    def watch_input(self, selector: Selector, bit: int) -> None:
        """See ``In.watch_input``."""
        self._inputs = (*self._inputs, (selector, bit))
        if self._fresh:
            selector.ready |= bit

    def unwatch_input(self, selector: Selector) -> None:
        """See ``In.unwatch_input``."""
        self._inputs = without(self._inputs, selector)

    def _alternative_waits(self) -> bool:
        for selector, bit in self._inputs:  # noqa: SIM110 - asked at every instant, and a generator takes three times as long
            if selector.armed & bit:
                return True
        return False


def refuse_cancelled() -> None:
    """A reader that was readied, and then cancelled before it ran, has not communicated: it ends here."""
    if scheduler.current.cancelled:
        raise Cancelled
