"""What ends a run from outside: signals.

While it is entered, the first signal that would have ended the process ends the run instead, so that outputs are released. Further ones
change nothing: they neither shorten the release nor begin it anew. Signals that the process was started to ignore (``nohup``, ``&`` in a script),
and those for which the program that runs the network has a handler of its own, stay as they are.
"""

from __future__ import annotations

import _thread
import atexit
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

_NAMES = (
    "SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGBREAK", "SIGABRT", "SIGALRM", "SIGUSR1", "SIGUSR2", "SIGVTALRM", "SIGPROF",
    "SIGXCPU", "SIGPOLL", "SIGPWR", "SIGSTKFLT",
)  # fmt: skip
"""Those that end a process unless somebody handles them, and that a process can handle. SIGPIPE is not among them: Python ignores it."""

SIGNALS: tuple[signal.Signals, ...] = tuple(signal.Signals[name] for name in _NAMES if hasattr(signal, name))

_SOON = 0.1
"""Seconds after which Stopped is raised wherever a program is."""
_AGAIN = 1.0
"""Seconds after which it is raised once more, where a program has swallowed it."""


class Stopped(BaseException):
    """A signal has come; raised in the main thread, and no process can catch it."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.signal = number

    @property
    def exit_code(self) -> int:
        """What a shell reports for a program that this signal has ended."""
        return exit_code_of(self.signal)


def exit_code_of(number: int) -> int:
    """128 and the signal: 130 for Ctrl-C."""
    return 128 + number


def name_of_signal(number: int) -> str:
    """As people write it."""
    return signal.Signals(number).name


class Stopping:
    """The handlers of signals of this process, and what they have heard. Entered again, it is the same."""

    def __init__(self) -> None:
        self.signal = 0
        """The first signal that has come; 0: none has."""
        self.call: object = None
        """The call of a driver that the main thread is in: what a driver does is not left in the middle."""
        self.last_resort: Callable[[list[BaseException]], None] | None = None
        """What a command does where a driver keeps the main thread for good: called with what went wrong, when the outputs are released."""
        self._raises = False
        self._heard = False
        self._since = 0.0
        self._patient = False
        self._entered = 0
        self._before: dict[int, Any] = {}
        self._overdue: tuple[object, BaseException] | None = None
        self._over: float | None = None

    def __enter__(self) -> Stopping:
        self._entered += 1
        if self._entered == 1:
            self.call = None
            self._raises = self._heard = False
            self._install()
        return self

    def __exit__(self, *_: object) -> None:
        self._entered -= 1
        if self._entered == 0:
            self._raises = False
            while self._before:
                number, handler = self._before.popitem()
                signal.signal(number, handler)
            late, self.signal = self.signal, 0
            if late and not self._heard:
                signal.raise_signal(late)  # It came when there was nothing left to stop: it is the caller's.

    def _install(self) -> None:
        if threading.current_thread() is not threading.main_thread():
            return
        for number in SIGNALS:
            handler = signal.getsignal(number)
            if handler in (signal.SIG_DFL, signal.default_int_handler):
                self._before[number] = handler
                signal.signal(number, self._stop)
        if hasattr(signal, "SIGURG") and signal.getsignal(signal.SIGURG) is signal.SIG_DFL:
            self._before[signal.SIGURG] = signal.SIG_DFL
            signal.signal(signal.SIGURG, self._leave)

    @contextmanager
    def raising(self, *, patiently: bool = False) -> Iterator[None]:
        """Within it a signal raises Stopped, but not in the middle of a driver's call.

        It does so at once, or ``patiently`` only where nobody asks for ``check`` soon, as in code that computes or waits for long.
        """
        self._raises = True
        self._patient = patiently and self.can_leave_calls
        try:
            self.check()
            yield
        finally:
            self._raises = False

    def hold(self) -> None:
        """From now on signals raise nothing."""
        self._raises = False

    def check(self) -> None:
        """Raises Stopped if a signal has come."""
        if self.signal:
            self._raise()

    def take(self) -> int:
        """The signal that has come, for who does what it asks for; 0: none has."""
        self._heard = bool(self.signal)
        return self.signal

    @property
    def waited(self) -> float:
        """Seconds since the first signal; 0 if none has come."""
        return time.monotonic() - self._since if self.signal else 0.0

    def _stop(self, number: int, frame: FrameType | None) -> None:
        now = time.monotonic()
        if self._over is not None and now > self._over + _AGAIN:
            os._exit(exit_code_of(number))
        if self.signal:
            return
        self.signal, self._since = number, now
        if self._raises and not self._patient:
            self._raise()
        elif self._raises:
            # Not by way of ``threading``, of which this may have interrupted something that holds a lock.
            _thread.start_new_thread(self._insist, ())

    def _insist(self) -> None:
        """In a thread of its own: raises Stopped in the main thread as often as needed."""
        time.sleep(_SOON)
        while self._raises:
            signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGURG)
            time.sleep(_AGAIN)

    def _raise(self) -> None:
        self._heard = True
        raise Stopped(self.signal)

    @property
    def can_leave_calls(self) -> bool:
        """Whether ``leave_call`` has an effect."""
        return hasattr(signal, "SIGURG") and signal.SIGURG in self._before

    def leave_call(self, call: object, error: BaseException) -> None:
        """Ends ``call`` by raising ``error`` in it, if the main thread is still in it; called from another thread."""
        self._overdue = call, error
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGURG)

    def _leave(self, number: int, frame: FrameType | None) -> None:
        overdue, self._overdue = self._overdue, None
        if overdue is not None and overdue[0] is self.call:
            raise overdue[1]
        if self.signal and self._raises and self.call is None:
            self._raise()

    @contextmanager
    def until_exit(self) -> Iterator[None]:
        """Enters it around all that a process does: what comes after that changes nothing any more.

        Otherwise a second signal could end the process by its default while the interpreter shuts down, and the exit code would say that. What comes
        a second later still ends a process that does not: a driver may have left a thread behind.
        """
        with self:
            atexit.register(self._ignore)
            try:
                yield
            finally:
                self._entered += 1
                self._over = time.monotonic()

    def _ignore(self) -> None:
        for number in self._before:
            signal.signal(number, signal.SIG_IGN)


stopping = Stopping()
"""Handlers of signals belong to the process; so does this."""
