"""Limits how long calls of drivers and steps of processes may take, and ends those that take longer."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any, Final, NamedTuple, TypeVar

from ..kernel.exceptions import DriverError, HangError, RunFailed
from ..kernel.places import line_by_hand, whereabouts
from ..kernel.signals import left_to_the_main_thread, name_of_signal
from ..kernel.stopping import Stopped, stopping
from ..real_time.preference import shift_priority
from .drivers import DriverFailed

T = TypeVar("T")

PATIENCE: Final = 2.0
"""Seconds that a driver has for a read or a write, and processes for a step."""
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
        """The exception that ends the run."""
        return DriverFailed(DriverError(self.driver, self.port, self.operation, error, line_by_hand(error)))

    def hangs(self) -> DriverFailed:
        """The exception for a call that has not returned in time."""
        return self.failed(TimeoutError(f"no return within {self.limit or PATIENCE:g} s"))


class _Present(NamedTuple):
    """A call that has begun."""

    call: Call
    since: float


class Watch:
    """Makes the calls of the scheduler's thread, and has a thread of its own that watches them and the steps of
    processes.

    What exceeds its limit is ended by an exception if Python can do that. If it still does not end, ``stuck`` is
    called, once, from the thread of the watch. ``look`` is called from there at regular intervals.
    """

    def __init__(self, *, look: Callable[[], None], stuck: Callable[[Exception], None]) -> None:
        self.releasing = False
        """Whether the run is over: calls then end by themselves, even if a signal arrives."""
        self.iterations = 0
        """The number of iterations of the scheduler, if steps have a limit."""
        self.limits_steps = False
        """Whether processes run against the clock, or end: the next iteration has to begin in time."""
        self._look = look
        self._stuck = stuck
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, name="watch of the drivers", daemon=True)
        self._scheduler = 0
        self._can_leave = False
        self._is_main = threading.current_thread() is threading.main_thread()
        self._call: _Present | None = None
        """The call that the scheduler's thread is in."""
        self._left: _Present | None = None
        self._gives_up = 0.0
        self._iteration = 0
        self._unchanged = 0
        """For how many looks the iteration was the same, outside of calls: time in which the process is suspended does
        not count.
        """

    def begin(self) -> None:
        """Begins to watch calls; called by the scheduler's thread."""
        self._scheduler = threading.get_ident()
        self._can_leave = stopping.can_leave_calls and threading.current_thread() is threading.main_thread()
        with left_to_the_main_thread():
            self._thread.start()

    def end(self) -> None:
        """Ends the thread."""
        self._ended.set()

    def call(self, what: Call, function: Callable[..., T], *given: Any) -> T:
        """Calls a driver. Raises DriverFailed with any exception that it raises, ``SystemExit`` included."""
        around = stopping.call
        self._call = _Present(what, time.monotonic())
        if self._is_main:
            stopping.call = self._call
        try:
            return function(*given)
        except BaseException as error:
            if stopping.ends_run(error):
                raise
            raise what.failed(error) from error
        finally:
            self._call = None
            if self._is_main:
                stopping.call = around
            if stopping.is_child:
                stopping.end_child()

    def _run(self) -> None:
        shift_priority(1)
        while not self._ended.wait(_LOOK):
            self._look()
            stopping.look()
            present = self._call
            hanging = stopping.lost
            if hanging is None:
                hanging = self._hanging_call(present) if present is not None else self._hanging_step()
            if hanging is None and stopping.waited > 2 * PATIENCE and not self.releasing:
                hanging = self._outlives_signal(present)
            if hanging is not None:
                self._stuck(hanging)
                return

    def _outlives_signal(self, present: _Present | None) -> Exception:
        """The error of a run that continues after a signal: where it is, in a driver or in a process."""
        if present is not None and self._is_overdue(present):
            return present.call.hangs().error
        return self._hang(f"within {2 * PATIENCE:g} s after {name_of_signal(stopping.signal)}")

    def _hanging_call(self, present: _Present) -> Exception | None:
        """Ends a call that takes too long. Returns the error of one that cannot be ended."""
        if not self._is_overdue(present):
            return None
        error = present.call.hangs().error
        if present is not self._left:
            self._left = present
            self._gives_up = time.monotonic() + PATIENCE
            self._leave(lambda: self._call is present, error)
        elif time.monotonic() > self._gives_up:
            return error
        return None

    def _is_overdue(self, present: _Present) -> bool:
        took = time.monotonic() - present.since
        limit = present.call.limit
        if limit is not None and took > limit:
            return True
        return not self.releasing and min(took, stopping.waited) > PATIENCE

    def _hanging_step(self) -> Exception | None:
        """Ends a step that takes too long. Returns the error of one that cannot be ended."""
        iteration = self.iterations
        if iteration != self._iteration or not self.limits_steps:
            self._iteration, self._unchanged = iteration, 0
            return None
        self._unchanged += 1
        took = self._unchanged * _LOOK
        if took <= PATIENCE:
            return None
        error = self._hang(f"within {PATIENCE:g} s")
        if took > 2 * PATIENCE:
            return error
        self._leave(lambda: self.iterations == iteration and self.limits_steps and self._call is None, error)
        return None

    def _hang(self, when: str) -> HangError:
        return HangError(f"{whereabouts(self._scheduler) or 'a process'} has not finished its step {when}")

    def _leave(self, still: Callable[[], bool], error: Exception) -> None:
        if self._can_leave:
            stops = stopping.signal and not self.releasing
            stopping.leave(still, Stopped(stopping.signal, error) if stops else RunFailed(error))
