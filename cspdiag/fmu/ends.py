"""What is said and done when an FMU ends the process: C's ``exit`` and crashes are not heard of in Python, and the exit
code may then be that of success.
"""

from __future__ import annotations

import atexit
import ctypes
import os
import signal
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from typing import Any

from cspdiag.fmu.description import FmuError

_CRASHES = ("SIGSEGV", "SIGBUS", "SIGFPE", "SIGILL", "SIGABRT")
_PATIENCE = 10
"""Seconds in which outputs are released, after which the process ends in any case."""


class Present:
    """The FMU that is being called, with what it does in words; nothing while none is."""

    path = ""
    doing = ""
    lose: Callable[[Exception], bool] | None = None
    """Tells a run why this thread will not return to it; whether the run then releases its outputs, writes the reason
    and ends the process, in another thread.
    """


present = Present()
_before: dict[int, int] = {}
"""The handlers of crashes that were there before, as addresses."""


@cache
def watch_ends() -> None:
    """From now on the end of the process in an FMU is reported, and outputs are released before. Nothing happens where
    the C library has other functions for that.
    """
    library = ctypes.CDLL(None) if os.name == "posix" else None
    if not (hasattr(library, "__cxa_atexit") and hasattr(library, "__cxa_finalize")):
        return
    assert library is not None
    own = ctypes.addressof(_OWN)
    library.__cxa_atexit(_EXITS, None, ctypes.c_void_p(own))
    # Before the interpreter ends: what it called after that would crash.
    atexit.register(library.__cxa_finalize, ctypes.c_void_p(own))
    library.signal.restype = ctypes.c_void_p
    library.signal.argtypes = [ctypes.c_int, ctypes.c_void_p]
    for name in _CRASHES:
        number = int(signal.Signals[name])
        _before[number] = library.signal(number, ctypes.cast(_CRASHED, ctypes.c_void_p)) or 0
        atexit.register(library.signal, number, _before[number])


def _exits(_: Any) -> None:
    if present.path:
        _report("has called exit, which ends the process")
        os._exit(1)


def _crashes(number: int) -> None:
    library: Any = ctypes.CDLL(None)
    # If the crash has left a lock of the C library behind, what follows waits for that forever.
    library.signal(int(signal.SIGALRM), None)
    library.alarm(_PATIENCE)
    library.signal(number, ctypes.c_void_p(_before[number]))
    if present.path:
        _report(f"has crashed ({signal.Signals(number).name})")
        library.signal(number, None)


def _report(what: str) -> None:
    """Says what the FMU did, after the outputs of the run, if there is one, have been released by the thread that
    watches it, which then ends the process.
    """
    error = FmuError(f"{present.path} {what}, {present.doing}", "")
    if present.lose is not None and present.lose(error):
        until = time.monotonic() + _PATIENCE
        while time.monotonic() < until:
            with suppress(BaseException):  # Nobody would hear of it.
                time.sleep(0.1)
    with suppress(BaseException):
        sys.stderr.write(f"cspdiag: {error}\n")
        sys.stderr.flush()


_OWN = ctypes.c_char(b"\0")
"""Its address says which functions are to be forgotten at the end."""
_EXITS = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(_exits)
_CRASHED = ctypes.CFUNCTYPE(None, ctypes.c_int)(_crashes)
