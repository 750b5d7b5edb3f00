"""The cost of work, as a number that is the same on every machine."""

from __future__ import annotations

import gc
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any


def calls(work: Callable[[], object]) -> int:
    """The number of functions that it calls, in Python and in C."""
    count = 0

    def called(_frame: FrameType, event: str, _argument: object) -> None:
        nonlocal count
        count += event in ("call", "c_call")

    with _no_collector():
        before = sys.getprofile()
        sys.setprofile(called)
        try:
            work()
        finally:
            sys.setprofile(before)
    return count


def lines(work: Callable[[], object]) -> int:
    """The number of lines of Python that it executes, including those in each iteration of loops and comprehensions."""
    count = 0

    def traced(_frame: FrameType, event: str, _argument: object) -> Any:
        nonlocal count
        count += event == "line"
        return traced

    with _no_collector():
        before = sys.gettrace()
        sys.settrace(traced)
        try:
            work()
        finally:
            sys.settrace(before)
    return count


@contextmanager
def _no_collector() -> Iterator[None]:
    """What a collection would call is what others left behind: finalizers and callbacks of weak references."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()
