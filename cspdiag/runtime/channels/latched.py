"""An end that keeps the latest value from outside until it is taken."""

from __future__ import annotations

from typing import Any

from ..kernel.exceptions import Cancelled
from ..kernel.party import Party
from ..kernel.scheduler import present
from .ports import In, T
from .selector import Selector, Watchers, lower_bits, without


class LatchedEnd(In[T]):
    """An end that keeps the latest value until it is taken: *fresh* until then.

    ``inputs`` are the alternatives that have a guard on this end.
    """

    __slots__ = ("fresh", "inputs", "name", "value")

    def __init__(self, name: str) -> None:
        self.name = name
        self.fresh = False
        self.value: Any = None
        self.inputs: Watchers = ()

    @property
    def collectable(self) -> bool:
        """See ``In.collectable``."""
        return self.fresh

    def take(self) -> T:
        """See ``In.take``."""
        return self.taken(present().current)

    def taken(self, reader: Party) -> T:
        """Takes the value on behalf of ``reader``."""
        return self._communicated(reader)

    def _communicated(self, reader: Party) -> T:
        self.fresh = False
        if self.inputs:
            lower_bits(self.inputs)
        observe = present().observe
        if observe is not None:
            observe(self.name, self.value, None, reader)
        return self.value  # type: ignore[no-any-return]

    def watch_input(self, selector: Selector, bit: int) -> None:
        """See ``In.watch_input``."""
        self.inputs = (*self.inputs, (selector, bit))
        if self.fresh:
            selector.ready |= bit

    def unwatch_input(self, selector: Selector) -> None:
        """See ``In.unwatch_input``."""
        self.inputs = without(self.inputs, selector)

    def alternative_waits(self) -> bool:
        """Whether an alternative is waiting for the end to become ready."""
        for selector, bit in self.inputs:  # noqa: SIM110 - asked at every instant, and a generator takes three times as long
            if selector.armed & bit:
                return True
        return False


def refuse_cancelled() -> None:
    """Ends a reader that was readied and then cancelled before it ran: it has not communicated."""
    if present().current.cancelled:
        raise Cancelled
