"""What waits in a channel, and for what."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any, Protocol, TypeAlias, Union

from .executed import Executed


class Entry(Protocol):
    """What can be in a ready queue: a party, or the generator of a task that is resumed directly."""

    def __next__(self) -> object:
        """Lets it continue until it waits; StopIteration: it has ended."""
        ...


ReadyQueue: TypeAlias = Union[list[Entry], "deque[Entry]"]


class Party(Protocol):
    """What can wait in a channel and then be in a ready queue.

    A party that is not a task itself makes its task the current one before it resumes that.
    """

    received: Any
    """The value that was handed over to a waiting reader."""

    @property
    def resume(self) -> Callable[[None], object]:
        """Lets it continue; called only by the scheduler."""
        ...

    def __next__(self) -> object:
        """``resume``, for a scheduler that resumes directly."""
        ...

    @property
    def ready_queue(self) -> ReadyQueue:
        """The queue of its level of priority."""
        ...

    @property
    def entry(self) -> Entry:
        """What is put into that queue when it is ready."""
        ...

    @property
    def process(self) -> Executed | None:
        """The process on whose behalf it waits."""
        ...


Waits: TypeAlias = "tuple[tuple[str, Any], ...]"
"""What a party waits for: words (``to read``) and the end of a channel, or None if it is not a channel. Of several
entries, one may be enough, or all be needed.
"""


class Waitable(Protocol):
    """What a task can wait for."""

    def withdraw(self, party: Party) -> bool:
        """Removes a waiting party; False if it no longer waits here."""
        ...

    def waits_for(self, party: Party) -> Waits:
        """What the party waits for, for the deadlock report."""
        ...
