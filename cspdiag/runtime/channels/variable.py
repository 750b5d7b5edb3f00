"""Ends that never wait: variables, constants, and the sink that takes everything.

Accessing them is not a communication: it is in no trace, and no process is cancelled there. A control law, however, is
cancelled where it writes, even if it writes to one of these.
"""

from __future__ import annotations

from collections.abc import Generator
from types import coroutine
from typing import Any

from ..kernel.exceptions import Cancelled, Fault
from ..kernel.party import Party
from ..kernel.scheduler import present
from .ports import In, Out, T, T_co, T_contra
from .selector import Selector

_NOT_WRITTEN: Any = object()


def _end_cancelled_law() -> None:
    task = present().current
    if task.cancelled and task.process is not None and task.process.is_law:
        raise Cancelled


class Variable(In[T], Out[T]):
    """The channel between processes in sequence: it holds one value, the last one written, and reading does not remove
    it.

    ``value`` is for conditions and assignments. Reading it before the first write is a ``Fault``.
    """

    __slots__ = ("name", "value")

    value: T

    def __init__(self, name: str = "variable", initial: T = _NOT_WRITTEN) -> None:
        self.name = name
        if initial is not _NOT_WRITTEN:
            self.value = initial

    def __getattr__(self, attribute: str) -> Any:
        """Reached only while ``value`` is not set."""
        if attribute == "value":
            raise Fault(f"{self.name} is read before it was written")
        raise AttributeError(attribute)

    @coroutine
    def read(self) -> Generator[None, None, T]:
        """The last value that was written."""
        return self.value
        yield

    @coroutine
    def write(self, value: T, /) -> Generator[None, None, None]:
        """Overwrites the value."""
        _end_cancelled_law()
        self.value = value
        return
        yield

    def request(self, party: Party) -> bool:
        """See ``In.request``."""
        party.received = self.value
        return True

    def offer(self, party: Party, value: T, /) -> bool:
        """See ``Out.offer``."""
        self.value = value
        return True

    def take(self) -> T:
        """See ``In.take``."""
        return self.value

    def withdraw(self, party: Party) -> bool:
        """See ``In.withdraw``."""
        return False

    def watch_input(self, selector: Selector, bit: int) -> None:
        """See ``In.watch_input``."""
        selector.ready |= bit

    def unwatch_input(self, selector: Selector) -> None:
        """See ``In.unwatch_input``."""

    def watch_output(self, selector: Selector, bit: int) -> None:
        """See ``Out.watch_output``."""
        selector.ready |= bit

    def unwatch_output(self, selector: Selector) -> None:
        """See ``Out.unwatch_output``."""


class Constant(In[T_co]):
    """An input that has its default value."""

    __slots__ = ("name", "value")

    def __init__(self, value: T_co, name: str = "constant") -> None:
        self.name = name
        self.value = value

    @coroutine
    def read(self) -> Generator[None, None, T_co]:
        """The constant."""
        return self.value
        yield

    def request(self, party: Party) -> bool:
        """See ``In.request``."""
        party.received = self.value
        return True

    def take(self) -> T_co:
        """See ``In.take``."""
        return self.value

    def withdraw(self, party: Party) -> bool:
        """See ``In.withdraw``."""
        return False

    def watch_input(self, selector: Selector, bit: int) -> None:
        """See ``In.watch_input``."""
        selector.ready |= bit

    def unwatch_input(self, selector: Selector) -> None:
        """See ``In.unwatch_input``."""


class Discard(Out[T_contra]):
    """Accepts every value at once, and forgets it."""

    __slots__ = ("name",)

    def __init__(self, name: str = "_") -> None:
        self.name = name

    @coroutine
    def write(self, value: T_contra, /) -> Generator[None, None, None]:
        """Continues at once."""
        _end_cancelled_law()
        return
        yield

    def offer(self, party: Party, value: T_contra, /) -> bool:
        """See ``Out.offer``."""
        return True

    def withdraw(self, party: Party) -> bool:
        """See ``Out.withdraw``."""
        return False

    def watch_output(self, selector: Selector, bit: int) -> None:
        """See ``Out.watch_output``."""
        selector.ready |= bit

    def unwatch_output(self, selector: Selector) -> None:
        """See ``Out.unwatch_output``."""
