"""What is due at which instant.

Timers of one instant fall due in the order in which they began. One heap entry serves all timers of an instant; entries
whose timers were all stopped stay in the heap until they are reached, and are then skipped.
"""

from __future__ import annotations

from collections.abc import Iterator
from heapq import heappop, heappush
from typing import Protocol


class Timer(Protocol):
    """Something that falls due."""

    def due(self) -> None:
        """Called when the instant has been reached, unless the timer was stopped."""
        ...


class Timers:
    """All timers that have begun, have not fallen due and were not stopped."""

    __slots__ = ("_at", "_instants")

    def __init__(self) -> None:
        self._instants: list[int] = []
        self._at: dict[int, dict[Timer, None]] = {}

    def begin(self, instant: int, timer: Timer) -> None:
        """From now on ``timer`` falls due at ``instant``."""
        timers = self._at.get(instant)
        if timers is None:
            self._at[instant] = {timer: None}
            heappush(self._instants, instant)
        else:
            timers[timer] = None

    def stop(self, instant: int, timer: Timer) -> bool:
        """Stops a timer; False if it was due already."""
        timers = self._at.get(instant)
        if timers is None or timer not in timers:
            return False
        del timers[timer]
        if not timers:
            del self._at[instant]
        return True

    def next_instant(self) -> int | None:
        """The earliest instant at which something is due."""
        instants = self._instants
        while instants:
            if instants[0] in self._at:
                return instants[0]
            heappop(instants)
        return None

    def instants(self) -> Iterator[int]:
        """The instant of each timer, in no order."""
        return (instant for instant, timers in self._at.items() for _ in timers)

    def fall_due(self, instant: int) -> None:
        """Calls the timers of ``instant``; one of them may stop others after it."""
        timers = self._at.get(instant)
        if timers is None:
            return
        if len(timers) == 1:
            (timer,) = self._at.pop(instant)
            timer.due()
            return
        for timer in list(timers):
            if self.stop(instant, timer):
                timer.due()
