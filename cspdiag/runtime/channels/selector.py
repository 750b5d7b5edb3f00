"""Which guards of an alternative are ready: a bit for each guard.

What makes a guard ready sets its bit, and what makes it unready clears it. A selection is therefore arithmetic on
integers, and costs the same for ten guards as for a thousand.

Invariant: bit k is set exactly while guard k is ready, whether or not the alternative is waiting.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Protocol, TypeAlias


class Waker(Protocol):
    """What waits for a guard."""

    def wake(self) -> None:
        """A first guard has become ready."""
        ...

    def enroll_late(self, bit: int) -> None:
        """The end of a guard now needs to know that the alternative is waiting."""
        ...


class Selector:
    """The part of an alternative that is known to its channels.

    ``armed`` are the guards that may wake the alternative; 0 when it does not wait or was woken already. ``attend`` are
    the guards whose ends are notified when the alternative begins and stops waiting. ``waiting`` is the alternative
    while it waits: the channels know only the selector, so an alternative that is no longer used is freed.
    """

    __slots__ = ("armed", "attend", "ready", "waiting")

    def __init__(self) -> None:
        self.ready = 0
        self.armed = 0
        self.attend = 0
        self.waiting: Waker | None = None

    def wake(self) -> None:
        """An armed guard has become ready."""
        self.armed = 0
        assert self.waiting is not None
        self.waiting.wake()


Watchers: TypeAlias = "tuple[tuple[Selector, int], ...]"


def raise_bits(watchers: Watchers) -> None:
    """A guard has become ready."""
    for selector, bit in watchers:
        selector.ready |= bit
        if selector.armed & bit:
            selector.wake()


def lower_bits(watchers: Iterable[tuple[Selector, int]]) -> None:
    """A guard is no longer ready."""
    for selector, bit in watchers:
        selector.ready &= ~bit


def attend(watchers: Watchers) -> None:
    """From now on the end is notified which alternatives wait."""
    for selector, bit in watchers:
        selector.attend |= bit
        if selector.waiting is not None:
            selector.waiting.enroll_late(bit)


def without(watchers: Watchers, selector: Selector) -> Watchers:
    """The other watchers."""
    return tuple(entry for entry in watchers if entry[0] is not selector)
