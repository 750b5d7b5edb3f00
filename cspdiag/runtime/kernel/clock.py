"""Time: virtual time jumps to the next instant as soon as nothing is ready; real time is that of the clock.

Both count nanoseconds from the start. Deadlines in real time are absolute: a late instant does not delay the next ones.
"""

from __future__ import annotations

import threading
import time
from typing import Protocol


class Clock(Protocol):
    """Decides when an instant has been reached."""

    real: bool

    def start(self) -> None:
        """Time 0 is now."""
        ...

    def now(self) -> int:
        """Nanoseconds since the start."""
        ...

    def reach(self, instant: int | None) -> bool:
        """Waits for the instant (None: forever); False if something arrived from outside before it."""
        ...

    def notify(self) -> None:
        """Something has arrived from outside; called from any thread."""
        ...


class VirtualClock:
    """Every instant is reached as soon as it is waited for."""

    real = False

    def start(self) -> None:
        """Does nothing: the scheduler keeps the time."""

    def now(self) -> int:
        """Always before the next instant: nothing takes time."""
        return 0

    def reach(self, instant: int | None) -> bool:
        """At once."""
        return True

    def notify(self) -> None:
        """Nothing waits."""


class RealClock:
    """The monotonic clock of the machine."""

    real = True

    def __init__(self) -> None:
        self._began = time.monotonic_ns()
        self._news = threading.Event()

    def start(self) -> None:
        """Time 0 is now."""
        self._began = time.monotonic_ns()

    def now(self) -> int:
        """Nanoseconds since the start."""
        return time.monotonic_ns() - self._began

    def reach(self, instant: int | None) -> bool:
        """See ``Clock.reach``."""
        while True:
            remaining = None if instant is None else instant - self.now()
            if remaining is not None and remaining <= 0:
                return True
            if self._news.wait(None if remaining is None else remaining / 1e9):
                self._news.clear()
                return False

    def notify(self) -> None:
        """See ``Clock.notify``."""
        self._news.set()
