"""What ends a run from outside: signals.

While it is entered, the first signal that would have ended the process ends the run instead, so that outputs are
released. Further ones change nothing: they neither shorten the release nor begin it anew. Signals that the process was
started to ignore (``nohup``, ``&`` in a script) stay ignored. A handler that somebody else has installed is called as
long as the run lasts; one that raises something ends it, and what comes during the release is handed to it afterwards.
"""

from __future__ import annotations

import _thread
import atexit
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Any

from .exceptions import HandlerError, HangError, RunEnded, RunFailed, described
from .signals import SIGNALS, exit_code_of, left_to_the_main_thread, name_of_signal

_USUAL = tuple(signal.Signals[name] for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT") if hasattr(signal, name))
_SOON = 0.1
"""Seconds after which Stopped is raised wherever a program is."""
_AGAIN = 1.0
"""Seconds after which it is raised once more, where a program has swallowed it."""


class Stopped(RunEnded):
    """A signal has come; raised in the main thread. ``hanging`` is what then had to be cut off, as it did not come to
    an end.
    """

    def __init__(self, number: int, hanging: Exception | None = None) -> None:
        super().__init__(number)
        self.signal = number
        self.hanging = hanging

    @property
    def exit_code(self) -> int:
        """What a shell reports for a program that this signal has ended."""
        return exit_code_of(self.signal)


class HandlerFailed(RunFailed):
    """A handler of somebody else has raised ``cause``."""

    def __init__(self, number: int, handler: Any, cause: BaseException) -> None:
        super().__init__(HandlerError(name_of_signal(number), handler, cause))
        self.cause = cause


class Stopping:
    """The handlers of signals of this process, and what they have heard. Entered again, it is the same."""

    def __init__(self) -> None:
        self.signal = 0
        """The first signal that has come; 0: none has."""
        self.call: object = None
        """The call of a driver that the main thread is in: what a driver does is not left in the middle."""
        self.say: Callable[[str], object] | None = None
        """How a command says something: set by a command, which consists of the run and ends with it."""
        self._runs: list[tuple[int, Callable[[], None]]] = []
        """The networks that run: the thread, and what keeps a child that is forked now from going on with it."""
        self.is_child = False
        """Whether this process was forked while a network ran, which is its parent's."""
        self._raises = False
        self._held = False
        self._heard = False
        self._since = 0.0
        self._patient = False
        self._entered = 0
        self._before: dict[int, Any] = {}
        self._theirs: dict[int, Any] = {}
        self._put_off: list[int] = []
        self._overdue: tuple[Callable[[], bool], RunEnded] | None = None
        self._over: float | None = None
        if hasattr(os, "register_at_fork"):
            os.register_at_fork(after_in_child=self._leave_to_child)

    def __enter__(self) -> Stopping:
        self._entered += 1
        if self._entered == 1:
            self.call = self._over = None
            self._raises = self._held = self._heard = False
        self.install()
        return self

    def __exit__(self, *_: object) -> None:
        self._entered -= 1
        if self._entered == 0:
            self._raises = False
            self._restore()
            late, self.signal = self.signal, 0
            put_off, self._put_off = self._put_off, []
            if late and not self._heard:
                put_off.insert(0, late)  # It came when there was nothing left to stop: it is the caller's.
            for number in put_off:
                signal.raise_signal(number)

    def _restore(self) -> None:
        self._theirs.clear()
        while self._before:
            number, handler = self._before.popitem()
            signal.signal(number, handler)

    def install(self) -> None:
        """Takes over the handlers of signals: also those that modules and drivers have installed since the
        last time.
        """
        if threading.current_thread() is not threading.main_thread():
            return
        for number in SIGNALS:
            handler = signal.getsignal(number)
            if handler in (signal.SIG_DFL, signal.default_int_handler):
                self._take_over(number, handler, self._stop)
            elif callable(handler) and not self._is_own(handler):
                self._take_over(number, handler, self._relay)
                self._theirs[number] = handler
        if hasattr(signal, "SIGURG") and signal.getsignal(signal.SIGURG) is signal.SIG_DFL:
            self._take_over(signal.SIGURG, signal.SIG_DFL, self._leave)

    def _take_over(self, number: int, before: Any, handler: Callable[[int, FrameType | None], None]) -> None:
        self._before.setdefault(number, before)
        signal.signal(number, handler)

    def _is_own(self, handler: Any) -> bool:
        return getattr(handler, "__self__", None) is self

    def look(self) -> None:
        """Has taken back what somebody has taken away since; called now and then from another thread."""
        for number in _USUAL:
            handler = signal.getsignal(number)
            if number in self._before and handler != signal.SIG_IGN and not self._is_own(handler):
                self._poke()
                return

    def _leave_to_child(self) -> None:
        """A driver has forked a child, which is none of our business: signals end it as they end any process, and what
        we drive is not its own.
        """
        for _, leave in self._runs:
            self.is_child = True
            leave()
        self._raises = False
        self.signal = 0
        self._restore()

    @contextmanager
    def running(self, leave: Callable[[], None]) -> Iterator[None]:
        """Around a run, with what keeps a child that is forked from going on with it. What a run inside of another does
        to signals, or one in another thread, ends with it.
        """
        before = self._raises, self._patient, self._held
        run = threading.get_ident(), leave
        is_inside = any(thread == run[0] for thread, _ in self._runs)
        self._runs.append(run)
        try:
            yield
        finally:
            self._runs.remove(run)
            if is_inside:
                self._raises, self._patient, self._held = before

    def end_child(self) -> None:
        """Ends a child that comes back from what has forked it."""
        if self.is_child:
            os._exit(1)

    @contextmanager
    def raising(self, *, patiently: bool = False) -> Iterator[None]:
        """Within it a signal raises Stopped, but not in the middle of a driver's call.

        It does so at once, or ``patiently`` only where nobody asks for ``check`` soon, as in code that computes or
        waits for long.
        """
        if threading.current_thread() is not threading.main_thread():
            self.check()
            yield
            return
        self._raises = True
        self._patient = patiently and self.can_leave_calls
        try:
            self.check()
            yield
        finally:
            self._raises = False

    def hold(self) -> None:
        """From now on signals raise nothing: a KeyboardInterrupt is not a signal, unless a driver puts a handler of its
        own in place later.
        """
        if threading.current_thread() is not threading.main_thread():
            return
        self._raises = False
        self._held = True
        if self._entered:
            self.install()

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

    def ends_run(self, error: BaseException) -> bool:
        """Whether ``error`` comes from outside of a program and its drivers, and ends the run: also Ctrl-C, where it is
        left to Python.
        """
        if isinstance(error, KeyboardInterrupt):
            if threading.current_thread() is not threading.main_thread():
                return False
            handler = signal.getsignal(signal.SIGINT)
            return callable(handler) and not self._is_own(handler)
        return isinstance(error, RunEnded)

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
            with left_to_the_main_thread():
                _thread.start_new_thread(self._insist, ())

    def _relay(self, number: int, frame: FrameType | None) -> None:
        """Calls the handler of somebody else. Of several that raise something only the first does: the release is not
        interrupted.
        """
        if self._held:
            self._put_off.append(number)
            return
        handler = self._theirs[number]
        try:
            handler(number, frame)
        except RunEnded:
            raise
        except BaseException as error:
            if not self._held:
                self._held = True
                raise HandlerFailed(number, handler, error) from error

    def _insist(self) -> None:
        """In a thread of its own: raises Stopped in the main thread as often as needed."""
        time.sleep(_SOON)
        while self._raises:
            self._poke()
            time.sleep(_AGAIN)

    def _raise(self) -> None:
        self._heard = True
        raise Stopped(self.signal)

    @property
    def is_entered(self) -> bool:
        """Whether anybody has entered it."""
        return self._entered > 0

    @property
    def can_leave_calls(self) -> bool:
        """Whether ``leave`` has an effect."""
        return hasattr(signal, "SIGURG") and signal.SIGURG in self._before

    def leave(self, still: Callable[[], bool], error: RunEnded) -> None:
        """Raises ``error`` in the main thread if what is to be left lasts ``still``; called from another thread."""
        self._overdue = still, error
        self._poke()

    def _poke(self) -> None:
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGURG)

    def _leave(self, number: int, frame: FrameType | None) -> None:
        if self._entered:
            self.install()
        overdue, self._overdue = self._overdue, None
        if overdue is not None and overdue[0]():
            raise overdue[1]
        if self.signal and self._raises and self.call is None:
            self._raise()

    def end_by_force(self, hanging: Exception, errors: Sequence[Exception]) -> None:
        """The main thread does not come back from what hangs; the outputs have been released from another one, which
        calls this.

        A command ends, and so does a process that a signal should have ended, or comes to. Where a driver hangs, an
        output may not be safe.
        """
        lines = [f"stopped by {name_of_signal(self.signal)}"] if self.signal else []
        lines += [described(error) for error in (hanging, *errors)]
        # What is written may hang as well, if the main thread is in the middle of writing.
        writing = threading.Thread(target=self._write_out, args=(lines,), daemon=True)
        writing.start()
        writing.join(_AGAIN)
        if self.say is not None or self.signal:
            is_fine = self.signal and isinstance(hanging, HangError) and not errors
            os._exit(exit_code_of(self.signal) if is_fine else 1)
        self._over = float("-inf")

    def _write_out(self, lines: Sequence[str]) -> None:
        for line in lines:
            if self.say is not None:
                self.say(line)
            else:
                sys.stderr.write(f"{line}\n")
        for stream in (sys.stdout, sys.stderr):
            with suppress(OSError, ValueError, AttributeError):
                stream.flush()

    @contextmanager
    def until_exit(self, say: Callable[[str], object]) -> Iterator[None]:
        """Enters it around all that a process does: what comes after that changes nothing any more.

        Otherwise a second signal could end the process by its default while the interpreter shuts down, and the exit
        code would say that. What comes a second later still ends a process that does not: a driver may have left a
        thread behind.
        """
        self.say = say
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
