"""What is due at which instant.

Timers of one instant fall due in the order in which they began. One heap entry serves all timers of an instant; entries
whose timers were all stopped stay in the heap until they are reached, and are then skipped.
"""

from __future__ import annotations

from collections.abc import Iterator
from heapq import heappop, heappush
from typing import Any, Protocol, TypeAlias

from .durations import shown
from .party import Party, Waits


class Timer(Protocol):
    """Something that falls due."""

    def due(self) -> None:
        """Called when the instant has been reached, unless the timer was stopped."""
        ...


_AtOnce: TypeAlias = "dict[Timer, None]"
"""Several timers of one instant, in the order in which they began."""


class Timers:
    """All timers that have begun, have not fallen due and were not stopped.

    ``heap`` has their instants, and those of timers that were stopped: if it is empty, nothing will fall due. ``at``
    has the timers of each instant.
    """

    __slots__ = ("_left_over", "at", "heap")

    def __init__(self) -> None:
        self.heap: list[int] = []
        self.at: dict[int, Timer | _AtOnce] = {}
        self._left_over = 0
        """How many entries of the heap are those of timers that were stopped."""

    def begin(self, instant: int, timer: Timer) -> None:
        """From now on ``timer`` falls due at ``instant``."""
        first = self.at.setdefault(instant, timer)
        if first is timer:
            heappush(self.heap, instant)
        elif isinstance(first, dict):
            first[timer] = None
        else:
            self.at[instant] = {first: None, timer: None}

    def stop(self, instant: int, timer: Timer) -> bool:
        """Stops a timer; False if it was due already."""
        present = self.at.get(instant)
        if isinstance(present, dict) and timer in present:
            del present[timer]
            if present:
                return True
        elif present is not timer:
            return False
        del self.at[instant]
        self._left_over += 1
        return True

    def next_instant(self) -> int | None:
        """The earliest instant at which something is due."""
        heap = self.heap
        while self._left_over and heap and heap[0] not in self.at:
            heappop(heap)
            self._left_over -= 1
        return heap[0] if heap else None

    def instants(self) -> Iterator[int]:
        """The instant of each timer, in no order."""
        for instant, present in self.at.items():
            yield from [instant] * (len(present) if isinstance(present, dict) else 1)

    def fall_due(self, instant: int) -> None:
        """Calls the timers of ``instant``; one of them may stop others after it."""
        present = self.at.get(instant)
        if isinstance(present, dict):
            for timer in list(present):
                if timer in present:
                    del present[timer]
                    if not present:
                        self._leave(instant)
                    timer.due()
        elif present is not None:
            self._leave(instant)
            present.due()

    def _leave(self, instant: int) -> None:
        """Nothing falls due any more at an instant that is reached."""
        del self.at[instant]
        if self.heap[0] == instant:
            heappop(self.heap)
        else:
            self._left_over += 1


class Sleeper(Party, Protocol):
    """A task, as far as delays need it."""

    scheduler: Any
    waiting: Any


class Delay:
    """A task that waits for an instant. The task uses it again for its next delay."""

    __slots__ = ("instant", "task")

    def __init__(self, task: Sleeper) -> None:
        self.task = task
        self.instant = 0

    def due(self) -> None:
        """See ``Timer.due``."""
        self.task.ready_queue.append(self.task.entry)

    def withdraw(self, party: Party) -> bool:
        """See ``Waitable.withdraw``."""
        timers: Timers = self.task.scheduler.timers
        return timers.stop(self.instant, self)

    def waits_for(self, party: Party) -> Waits:
        """See ``Waitable.waits_for``."""
        return ((f"until {shown(self.instant)}", None),)


def begin_delay(task: Sleeper, duration: int) -> None:
    """Readies ``task`` when ``duration``, which is positive, has passed."""
    scheduler = task.scheduler
    delay = task.waiting
    if type(delay) is not Delay:
        delay = task.waiting = Delay(task)
    delay.instant = instant = scheduler.now + duration
    timers: Timers = scheduler.timers
    first = timers.at.setdefault(instant, delay)  # As ``begin``, without a call.
    if first is delay:
        heappush(timers.heap, instant)
    elif isinstance(first, dict):
        first[delay] = None
    else:
        timers.begin(instant, delay)
