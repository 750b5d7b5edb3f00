"""What waits in a channel, and for what."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any, Protocol, TypeAlias

from .executed import Executed


class Party(Protocol):
    """What can wait in a channel and then be in a ready queue.

    ``resume`` goes on with it; only the scheduler calls it. A party that is no task makes its task the current one
    before it resumes it.
    """

    received: Any
    """The value that was handed over to a waiting reader."""

    @property
    def resume(self) -> Callable[[None], object]:
        """Goes on; called by the scheduler only."""
        ...

    @property
    def ready_queue(self) -> list[Party] | deque[Party]:
        """The queue of its level of priority."""
        ...

    @property
    def process(self) -> Executed | None:
        """The process on whose behalf it waits."""
        ...


Waits: TypeAlias = "tuple[tuple[str, Any], ...]"
"""What a party waits for: words (``to read``) and the end of a channel, or words alone and None; one of several is
enough, or all.
"""


class Waitable(Protocol):
    """What a task can wait for."""

    def withdraw(self, party: Party) -> bool:
        """Takes a waiting party back; False if it does not wait here any longer."""
        ...

    def waits_for(self, party: Party) -> Waits:
        """What the party waits for, for the deadlock report."""
        ...
