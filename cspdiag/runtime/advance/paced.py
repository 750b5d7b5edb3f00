"""A run against the clock that its caller continues piece by piece, in one thread, with its drivers as ``Network.run``
has them. Between two pieces nothing happens, so the caller comes back soon.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from typing import Literal

from ..kernel.clock import RealClock
from ..kernel.observer import Observer
from ..kernel.stopping import stopping
from ..network import Network
from ..outcome import Outcome
from ..outside.instants import Environment
from .resumable import ResumableRun


class PacedRun(ResumableRun):
    """One run of a network, up to ``until`` (an instant in nanoseconds). Time 0 is when its drivers have been opened.

    Until it has ended, signals end it (``stopping``): their handlers, if they raise exceptions, by HandlerFailed, which
    the caller has to expect between two pieces as well.
    """

    def __init__(
        self,
        network: Network,
        environment: Environment | None = None,
        *,
        until: int | None = None,
        on_miss: Literal["timeout", "count"] = "timeout",
        observer: Observer | None = None,
    ) -> None:
        self._own_clock = RealClock()
        self._entered = ExitStack()
        self._entered.enter_context(stopping)
        try:
            super().__init__(
                network, environment, on_miss=on_miss, observer=observer, clock=self._own_clock, until=until
            )
        except BaseException:
            self._entered.close()
            raise

    @property
    def present(self) -> int:
        """What the clock shows, in nanoseconds."""
        return self._own_clock.now()

    def advance(self, until: int, wants_pause: Callable[[], bool] | None = None) -> bool:
        """Continues until the clock shows ``until``; it waits for nothing else, and no pause is wanted of it."""
        if self.outcome is None:
            with self._scheduler:
                ending = self._run.caught(lambda: self._run.in_real_time(until))
            if ending is not None:
                self._end(ending)
        return True

    def _end(self, outcome: Outcome) -> None:
        with self._entered:
            super()._end(outcome)
