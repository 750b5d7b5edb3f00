"""A driver that gives the value of an input when a process reads it, and not before."""

from __future__ import annotations

from typing import Any

from ..channels.ports import In, T
from ..channels.selector import Selector, lower_bits
from ..kernel.party import Party
from ..kernel.scheduler import Task, present


class Supply:
    """The driver of any number of ports. It may be read at any time until it is ``dry``; outputs are handed to it at
    once.
    """

    def __init__(self) -> None:
        self.dry = False
        self._ends: list[SuppliedEnd[Any]] = []

    def value(self, port: str, reader: Task) -> Any:
        """What ``reader`` reads. Raises Timeout for a sample that was missed."""
        raise NotImplementedError

    def read(self) -> Any:
        """Never used at a tick."""
        raise AssertionError("its values are read by processes, not at ticks")

    def write(self, value: object) -> None:
        """Takes everything."""

    def end_of(self, port: str) -> SuppliedEnd[Any]:
        """An end to read from."""
        end: SuppliedEnd[Any] = SuppliedEnd(port, self)
        self._ends.append(end)
        return end

    def run_dry(self) -> None:
        """From now on it gives no value."""
        self.dry = True
        for end in self._ends:
            lower_bits(end.inputs)


class SuppliedEnd(In[T]):
    """The end of a process that reads from a supply."""

    __slots__ = ("_supply", "inputs", "name")

    def __init__(self, name: str, supply: Supply) -> None:
        self.name = name
        self.inputs: list[tuple[Selector, int]] = []
        self._supply = supply

    def request(self, party: Party) -> bool:
        """See ``In.request``."""
        if self._supply.dry:
            return False
        party.received = self.take()
        return True

    def take(self) -> T:
        """See ``In.take``."""
        scheduler = present()
        reader = scheduler.current
        value: T = self._supply.value(self.name, reader)
        if scheduler.observe is not None:
            scheduler.observe(self.name, value, None, reader)
        return value

    def withdraw(self, party: Party) -> bool:
        """See ``In.withdraw``."""
        return True

    def watch_input(self, selector: Selector, bit: int) -> None:
        """See ``In.watch_input``: ready until it is dry."""
        self.inputs.append((selector, bit))
        if not self._supply.dry:
            selector.ready |= bit

    def unwatch_input(self, selector: Selector) -> None:
        """See ``In.unwatch_input``."""
        self.inputs = [entry for entry in self.inputs if entry[0] is not selector]
