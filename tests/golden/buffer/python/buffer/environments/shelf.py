"""The environment Shelf."""

from __future__ import annotations

from collections.abc import Mapping

from ..runtime import Driver, Signal, ms


class Shelf:
    """The environment Shelf.

    Source: buffer.csp:82
    """

    step = 1 * ms
    on_miss = "timeout"

    def __init__(self) -> None:
        self.now = 0
        self.done = Signal[int](0)
        self.drivers: Mapping[str, Driver] = {"done": self.done}

    def start(self) -> None:
        """Go to time 0 and evaluate the outputs."""
        self.now = 0

    def advance(self, now: int) -> None:
        """Integrate to `now` (in nanoseconds) with the inputs held, and evaluate the outputs."""
        self.now = now
