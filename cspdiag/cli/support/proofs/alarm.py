"""The time limit of an answer, kept also where no code looks at the clock."""

from __future__ import annotations

import gc
import signal
import sys
import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import TYPE_CHECKING, cast

if TYPE_CHECKING:
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
    library makes of it counts as it does. On systems that have no timers with signals, and outside of the main thread,
    it does nothing.
    """
    if not hasattr(signal, "setitimer") or threading.current_thread() is not threading.main_thread():
        yield
        return
    from cspdiag.proofs.verdict import LimitError

    rings, has_rung = True, False

    def ring(_: int, frame: FrameType | None) -> None:
        nonlocal has_rung
        if rings and _is_importing(frame):
            signal.setitimer(signal.ITIMER_REAL, SOON, LATER)
        elif rings:
            if not has_rung:
                # What is cut off may not end properly when it is collected, and is then of no interest: to no function
                # that could be cut off itself.
                sys.unraisablehook = id
                warnings.filterwarnings("ignore", "coroutine .* was never awaited", RuntimeWarning)
            has_rung = True
            raise _ending_runs(limits.time_is_up())

    before, hook = signal.signal(signal.SIGALRM, ring), sys.unraisablehook
    with warnings.catch_warnings():
        try:
            signal.setitimer(signal.ITIMER_REAL, max(limits.remaining, 0.0) + LATER, LATER)
            try:
                yield
            except (LimitError, Exception):
                if not has_rung:
                    raise
                is_cut_off = True
            else:
                is_cut_off = False
            finally:
                rings = False
            if has_rung:
                gc.collect()
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            signal.signal(signal.SIGALRM, before)
            sys.unraisablehook = hook
    if is_cut_off:
        raise limits.time_is_up()


def _ending_runs(error: LimitError) -> LimitError:
    """The error as one that also ends a run of a program, if its runtime is there."""
    runtime = sys.modules.get("cspdiag.runtime.kernel.exceptions")
    if runtime is None:
        return error
    return cast("LimitError", type("TimeIsUpError", (type(error), runtime.RunEnded), {})(*error.args))


def _is_importing(frame: FrameType | None) -> bool:
    """Whether a module is being loaded: one of which only a part was made cannot be loaded again."""
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False
