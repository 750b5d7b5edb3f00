"""Ensures that a native program ends when it should."""

from __future__ import annotations

import signal
import subprocess
import threading
import time

from cspdiag.base.errors import CspdiagError
from cspdiag.runtime.kernel.exceptions import OutsideError
from cspdiag.runtime.kernel.signals import left_to_the_main_thread, name_of_signal
from cspdiag.runtime.kernel.stopping import stopping

PATIENCE = 2.0
"""The seconds within which a native program must end after a signal has arrived or it has reported its end."""
_POLL_INTERVAL = 0.05
_LONGEST = 2000
"""Bytes of what a program has written that are repeated: the last ones, as its kernel says at the end what crashed."""
_CRASHES = (
    signal.SIGSEGV, signal.SIGBUS, signal.SIGFPE, signal.SIGILL, signal.SIGABRT, signal.SIGTRAP, signal.SIGSYS,
)  # fmt: skip
_EXIT = "exit was called"
"""How the line begins that the kernel writes then (``csp_signals.c``)."""


class KilledError(OutsideError, CspdiagError):
    """A native program had to be killed, for the reason in the message."""


class Supervisor:
    """Forwards signals to the native program, which then ends by itself; if it does not end in time, it is killed. This
    happens in a thread of its own, because the main one reads what the program reports. ``signal`` is the first signal
    that arrived, ``killed`` whether the program was killed.
    """

    def __init__(self, program: subprocess.Popen[bytes]) -> None:
        self._program = program
        self._ended = threading.Event()
        self._until: float | None = None
        self._thread = threading.Thread(target=self._run, name="supervisor of the native program", daemon=True)
        self.signal = 0
        self.killed = False

    @property
    def kill_error(self) -> KilledError:
        """The message about the program that was killed."""
        why = "after it had reported its end" if not self.signal else f"after {name_of_signal(self.signal)}"
        return KilledError(f"the native program did not end within {PATIENCE:g} s {why}, and was killed")

    def __enter__(self) -> Supervisor:
        with left_to_the_main_thread():
            self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()

    def end_reported(self) -> None:
        """Note that the program has reported its end: it has nothing left to do."""
        self._until = time.monotonic() + PATIENCE

    def stopped_by(self, code: int) -> int:
        """The signal that has stopped the program, which ended with that exit code: one that this process has received,
        or one that a body in C has raised.
        """
        raised = code - 128
        return self.signal or (raised if raised in signal.valid_signals() else signal.SIGTERM)

    def _run(self) -> None:
        while not self._ended.wait(_POLL_INTERVAL):
            if stopping.signal and not self.signal:
                self.signal = stopping.take()
                self._program.send_signal(signal.SIGTERM)  # The program never ignores this one.
                self._until = time.monotonic() + PATIENCE
            if self._until is not None and time.monotonic() > self._until and self._program.poll() is None:
                self.killed = True
                self._program.kill()
                return


def how_it_ended(code: int, written: bytes) -> str:
    """Why a native program ended without a report, from its exit code and what it has ``written`` for people: a signal,
    also one after which it has still released its outputs, or what it gave as the reason.
    """
    text = written[-_LONGEST:].decode("utf-8", "replace").strip()
    number = -code if code < 0 else code - 128
    if number in signal.valid_signals():
        crash = ", a crash such as that of a body in C or an FMU" if number in _CRASHES else ""
        how = f"it was ended by {name_of_signal(number)}{crash}"
    elif not text or any(line.startswith(_EXIT) for line in text.splitlines()):
        how = f"exit code {code} before the end of the run, as if a body in C or an FMU had called exit"
    else:
        return text
    return "\n  ".join([how, *text.splitlines()])
