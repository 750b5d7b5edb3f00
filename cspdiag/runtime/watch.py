"""Calls of drivers: how long each may take, and what becomes of one that does not come back."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any, Final, NamedTuple, TypeVar

from .drivers import DriverFailed
from .exceptions import DriverError
from .stopping import Stopped, stopping

T = TypeVar("T")

PATIENCE: Final = 2.0
"""Seconds that a driver has for a read or a write."""
PATIENCE_AT_CLOSE: Final = 10.0
"""Seconds that a driver has to close."""
_LOOK: Final = 0.1


class Call(NamedTuple):
    """One operation of a driver. Without a limit it may take as long as it likes, until a signal comes."""

    driver: str
    port: str
    operation: str
    limit: float | None

    def failed(self, error: BaseException) -> DriverFailed:
        """What ends the run."""
        return DriverFailed(DriverError(self.driver, self.port, self.operation, error))

    def hangs(self) -> DriverFailed:
        """It has not come back in time."""
        return self.failed(TimeoutError(f"no return within {self.limit or PATIENCE:g} s"))


class _Present(NamedTuple):
    """A call that has begun."""

    call: Call
    since: float


class Watch:
    """Makes the calls of the scheduler's thread, and has a thread of its own that looks after them.

    A call beyond its limit is ended by an exception where Python can do that. If it still does not come back, ``stuck`` is called, once, from the
    thread of the watch. ``look`` is called from there all the time.
    """

    def __init__(self, *, look: Callable[[], None], stuck: Callable[[DriverFailed], None]) -> None:
        self.releasing = False
        """Whether the run is over: calls then come to an end of their own, signal or not."""
        self._look = look
        self._stuck = stuck
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, name="watch of the drivers", daemon=True)

    def begin(self) -> None:
        """From now on calls are looked after."""
        self._thread.start()

    def end(self) -> None:
        """There will be no more calls."""
        self._ended.set()

    def call(self, what: Call, function: Callable[..., T], *given: Any) -> T:
        """Calls a driver. Raises DriverFailed with whatever it raises, ``sys.exit`` included."""
        stopping.call = _Present(what, time.monotonic())
        try:
            return function(*given)
        except (DriverFailed, Stopped, KeyboardInterrupt):
            raise
        except BaseException as error:
            raise what.failed(error) from error
        finally:
            stopping.call = None

    def _run(self) -> None:
        left: _Present | None = None
        gives_up = 0.0
        while not self._ended.wait(_LOOK):
            self._look()
            present = stopping.call
            if not isinstance(present, _Present) or not self._is_overdue(present):
                continue
            if present is not left:
                left = present
                gives_up = time.monotonic() + PATIENCE
                if stopping.can_leave_calls:
                    stops = stopping.signal and not self.releasing
                    stopping.leave_call(present, Stopped(stopping.signal) if stops else present.call.hangs())
            elif time.monotonic() > gives_up:
                self._stuck(present.call.hangs())
                return

    def _is_overdue(self, present: _Present) -> bool:
        took = time.monotonic() - present.since
        limit = present.call.limit
        if limit is not None and took > limit:
            return True
        return not self.releasing and min(took, stopping.waited) > PATIENCE
