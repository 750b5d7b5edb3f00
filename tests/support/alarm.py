"""An alarm that is noticed in any case."""

from __future__ import annotations

import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import NoReturn

AGAIN = 1
"""Seconds after which it rings again: an exception raised while the garbage collector calls Python code is lost."""


@contextmanager
def alarm_after(seconds: float, ring: Callable[[], NoReturn], *, computing: bool = False) -> Iterator[None]:
    """Call ``ring``, which raises, again and again once the block has taken this many seconds, of computing time if
    ``computing``.
    """

    def rung(_number: int, _frame: FrameType | None) -> None:
        sys.unraisablehook = id
        ring()

    timer, number = (signal.ITIMER_VIRTUAL, signal.SIGVTALRM) if computing else (signal.ITIMER_REAL, signal.SIGALRM)
    before, hook = signal.signal(number, rung), sys.unraisablehook
    signal.setitimer(timer, seconds, AGAIN)
    try:
        yield
    finally:
        signal.setitimer(timer, 0)
        signal.signal(number, before)
        sys.unraisablehook = hook
