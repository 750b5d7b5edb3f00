"""The time limit of an answer, kept also where nobody looks at the clock."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cspdiag.analyses.proofs.verdict import Limits

LATER = 0.5
"""Seconds after the time limit at which the alarm rings, and then again and again: whoever looks at the clock ends by himself before, and has more to tell."""


@contextmanager
def ended_by_alarm(limits: Limits) -> Iterator[None]:
    """Raises LimitError in the body, wherever it is, soon after the time is up.

    On systems that have no timers with signals, and outside of the main thread, it does nothing.
    """
    if not hasattr(signal, "setitimer") or threading.current_thread() is not threading.main_thread():
        yield
        return
    rings = True

    def ring(*_: object) -> None:
        if rings:
            raise limits.time_is_up()

    before = signal.signal(signal.SIGALRM, ring)
    try:
        signal.setitimer(signal.ITIMER_REAL, max(limits.remaining, 0.0) + LATER, LATER)
        try:
            yield
        finally:
            rings = False
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
