"""The time limit of an answer, kept also where no code looks at the clock."""

from __future__ import annotations

import gc
import sys
import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType

from cspdiag.proofs.verdict import LimitError, Limits

LATER = 0.5
"""Seconds after the time limit at which the alarm rings, and then again and again: what looks at the clock ends by
itself before, and has more to report.
"""

SOON = 0.01
"""Seconds after which it rings once more where it must not interrupt."""


@contextmanager
def ended_by_alarm(limits: Limits) -> Iterator[None]:
    """Raises LimitError in the body, wherever it is, soon after the time is up.

    What is interrupted may not take that for something else: processes of the program do not catch it, and what a
    library makes of it counts as it does. It takes no signals, which belong to the program that calls, and works in
    every thread; where there are no threads, and in other interpreters than CPython, it does nothing.
    """
    alarm = _Alarm(limits)
    with warnings.catch_warnings():
        try:
            alarm.start()
            try:
                yield
            except (LimitError, Exception):
                if not alarm.has_rung:
                    raise
                is_cut_off = True
            else:
                is_cut_off = False
            finally:
                while not alarm.is_stopped:
                    try:  # noqa: SIM105 - to enter a context could be cut off, too.
                        alarm.stop()
                    except LimitError:
                        pass
            if alarm.has_rung:
                gc.collect()
        finally:
            alarm.restore()
    if is_cut_off:
        raise limits.time_is_up()


class _Alarm:
    """Rings in the thread that makes it: CPython raises an exception there between two of its instructions."""

    def __init__(self, limits: Limits) -> None:
        self.has_rung = False
        self.is_stopped = False
        self._limits = limits
        self._interrupted = threading.get_ident()
        self._over = threading.Event()
        self._ringing = threading.Lock()
        self._hook = sys.unraisablehook
        self._thread = threading.Thread(target=self._wait, name="time limit", daemon=True)

    def start(self) -> None:
        """Begin to wait for the end of the time."""
        if sys.implementation.name != "cpython":
            return
        with suppress(RuntimeError):  # There are no threads.
            self._thread.start()

    def stop(self) -> None:
        """Ring no more; is cut off itself where it rings just now, or has rung before."""
        with self._ringing:
            self._over.set()
        self.is_stopped = True
        if self.has_rung:
            # An error may still be on its way. A last one takes its place and is awaited: to withdraw it would leave
            # the interpreter (3.11, 3.12) looking for it without end, which hangs the process as soon as it is traced.
            _raise_in(self._interrupted, LimitError)
            while True:
                pass

    def restore(self) -> None:
        """Report again what fails where it cannot be caught, and wait for the thread.

        It ends here also if ``stop`` was never reached, because a further ring cut off what comes before.
        """
        sys.unraisablehook = self._hook
        self._over.set()
        if self._thread.is_alive():
            self._thread.join()

    def _wait(self) -> None:
        pause = max(self._limits.remaining, 0.0) + LATER
        while not self._over.wait(pause):
            with self._ringing:
                pause = LATER if self._ring() else SOON

    def _ring(self) -> bool:
        if self._over.is_set() or _is_importing(sys._current_frames().get(self._interrupted)):
            return False
        if not self.has_rung:
            # What is cut off may not end properly when it is collected, and is then of no interest: to no function
            # that could be cut off itself.
            sys.unraisablehook = id
            warnings.filterwarnings("ignore", "coroutine .* was never awaited", RuntimeWarning)
        self.has_rung = True
        _raise_in(self._interrupted, _ending_runs(self._limits.time_is_up()))
        return True


def _raise_in(thread: int, error: type[LimitError]) -> None:
    """Have a thread raise an error at its next instruction, instead of one that it was to raise and has not yet."""
    import ctypes

    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), ctypes.py_object(error))


def _ending_runs(error: LimitError) -> type[LimitError]:
    """An error like this one that also ends a run of a program, if its runtime is there."""
    runtime = sys.modules.get("cspdiag.runtime.kernel.exceptions")
    bases = (LimitError,) if runtime is None else (LimitError, runtime.RunEnded)

    def initialize(self: LimitError) -> None:
        LimitError.__init__(self, *error.args)

    return type("TimeIsUpError", bases, {"__init__": initialize})


def _is_importing(frame: FrameType | None) -> bool:
    """Whether a module is being loaded: one of which only a part was made cannot be loaded again."""
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False
