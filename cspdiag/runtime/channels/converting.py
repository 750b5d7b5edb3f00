"""Ends to write to for hand-written processes, whose values are not of the type of the port by themselves."""

from __future__ import annotations

from collections.abc import Callable, Generator
from types import coroutine
from typing import Any, Generic

from ..kernel.party import Party, Waits
from .ports import Out, T_contra
from .selector import Selector


class Converting(Out[T_contra], Generic[T_contra]):
    """``end``, to which everything is written as ``converted`` by a function that raises Fault, TypeError or the like
    for what is not a value of the type.
    """

    __slots__ = ("converted", "end", "name")

    def __init__(self, end: Out[Any], converted: Callable[[Any], T_contra]) -> None:
        self.end = end
        self.converted = converted
        self.name = end.name

    @coroutine
    def write(self, value: T_contra, /) -> Generator[None, None, None]:
        """See ``Out.write``."""
        yield from self.end.write(self.converted(value))

    def offer(self, party: Party, value: T_contra, /) -> bool:
        """See ``Out.offer``."""
        return self.end.offer(party, self.converted(value))

    def choose_output(self, party: Party, value: T_contra, /) -> bool:
        """See ``Out.choose_output``."""
        return self.end.choose_output(party, self.converted(value))

    def withdraw(self, party: Party) -> bool:
        """See ``Out.withdraw``."""
        return self.end.withdraw(party)

    def waits_for(self, party: Party) -> Waits:
        """See ``Out.waits_for``."""
        return self.end.waits_for(party)

    def watch_output(self, selector: Selector, bit: int) -> None:
        """See ``Out.watch_output``."""
        self.end.watch_output(selector, bit)

    def unwatch_output(self, selector: Selector) -> None:
        """See ``Out.unwatch_output``."""
        self.end.unwatch_output(selector)
