"""What ends a run from outside: signals.

While ``stopping`` is entered, the first signal that would have ended the process ends the run instead, so that outputs
are released. Further ones have no effect: they neither shorten the release nor restart it. Signals that the process was
started to ignore (``nohup``, ``&`` in a script) stay ignored. Handlers installed by others are called as long as the
run lasts. One that raises an exception ends the run; signals that arrive during the release are handed to it
afterwards.
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
"""Seconds after which Stopped is raised, whatever the program is doing."""
_AGAIN = 1.0
"""Seconds after which it is raised again, if the program has swallowed it."""


class Stopped(RunEnded):
    """A signal has arrived; raised in the main thread. ``hanging`` is what then had to be cut off, if anything."""

    def __init__(self, number: int, hanging: Exception | None = None) -> None:
        super().__init__(number)
        self.signal = number
        self.hanging = hanging

    @property
    def exit_code(self) -> int:
        """What a shell reports for a program that this signal has ended."""
        return exit_code_of(self.signal)


class HandlerFailed(RunFailed):
    """A handler that is not the runtime's has raised ``cause``."""

    def __init__(self, number: int, handler: Any, cause: BaseException) -> None:
        super().__init__(HandlerError(name_of_signal(number), handler, cause))
        self.cause = cause


class Stopping:
    """The signal handlers of this process, and the signals that they have received. May be entered more than once."""

    def __init__(self) -> None:
        self.signal = 0
        """The first signal that has arrived; 0: none has."""
        self.call: object = None
        """The driver's call that the main thread is in: calls of drivers are not interrupted."""
        self.lost: Exception | None = None
        """Why the main thread will not return from the code in another language that it is in."""
        self.say: Callable[[str], object] | None = None
        """Prints a message; set by a command, which consists of the run and ends with it."""
        self._runs: list[tuple[int, Callable[[], None]]] = []
        """The networks that are running: the thread of each, and the function that keeps a child forked now from
        continuing the run.
        """
        self.is_child = False
        """Whether this process was forked while a network of its parent was running."""
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
                put_off.insert(0, late)  # It arrived when there was nothing left to stop: the caller handles it.
            for number in put_off:
                signal.raise_signal(number)

    def _restore(self) -> None:
        self._theirs.clear()
        while self._before:
            number, handler = self._before.popitem()
            signal.signal(number, handler)

    def install(self) -> None:
        """Takes over the handlers of signals, including those that modules and drivers have installed since the last
        time.
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
        """Has the main thread reinstall handlers that were replaced since; called regularly from another thread."""
        for number in _USUAL:
            handler = signal.getsignal(number)
            if number in self._before and handler != signal.SIG_IGN and not self._is_own(handler):
                self._poke()
                return

    def _leave_to_child(self) -> None:
        """Called in a child that a driver has forked: signals end it as they end any process, and it does not own the
        outputs.
        """
        for _, leave in self._runs:
            self.is_child = True
            leave()
        self._raises = False
        self.signal = 0
        self._restore()

    @contextmanager
    def running(self, leave: Callable[[], None]) -> Iterator[None]:
        """Surrounds a run; ``leave`` keeps a forked child from continuing that. Changes of signal handlers by a run
        inside another one, or in another thread, are undone when it ends.
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
        """Ends a child that returns from the function that has forked it."""
        if self.is_child:
            os._exit(1)

    @contextmanager
    def raising(self, *, patiently: bool = False) -> Iterator[None]:
        """Within it a signal raises Stopped, but not during a driver's call.

        It does so at once or, if ``patiently``, only where ``check`` is not called soon, as in code that computes or
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
        """From now on signals raise nothing. Nor does Ctrl-C raise KeyboardInterrupt, unless a driver later installs a
        handler of its own.
        """
        if threading.current_thread() is not threading.main_thread():
            return
        self._raises = False
        self._held = True
        if self._entered:
            self.install()

    def check(self) -> None:
        """Raises Stopped if a signal has arrived."""
        if self.signal:
            self._raise()

    def take(self) -> int:
        """The signal that has arrived, for a caller that then handles it; 0: none has."""
        self._heard = bool(self.signal)
        return self.signal

    @property
    def waited(self) -> float:
        """Seconds since the first signal; 0 if none has arrived."""
        return time.monotonic() - self._since if self.signal else 0.0

    def ends_run(self, error: BaseException) -> bool:
        """Whether ``error`` comes from outside of a program and its drivers, and ends the run. So does Ctrl-C if it is
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
            # Does not use ``threading``: this may have interrupted a function of it that holds a lock.
            with left_to_the_main_thread():
                _thread.start_new_thread(self._insist, ())

    def _relay(self, number: int, frame: FrameType | None) -> None:
        """Calls a handler that is not the runtime's. If several raise exceptions, only that of the first is raised: the
        release is not interrupted.
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
        """Runs in a thread of its own: raises Stopped in the main thread as often as needed."""
        time.sleep(_SOON)
        while self._raises:
            self._poke()
            time.sleep(_AGAIN)

    def _raise(self) -> None:
        self._heard = True
        raise Stopped(self.signal)

    @property
    def is_entered(self) -> bool:
        """Whether it is entered."""
        return self._entered > 0

    @property
    def can_leave_calls(self) -> bool:
        """Whether ``leave`` has an effect."""
        return hasattr(signal, "SIGURG") and signal.SIGURG in self._before

    def leave(self, still: Callable[[], bool], error: RunEnded) -> None:
        """Called from another thread: raises ``error`` in the main thread while that is ``still`` in what it must
        leave.
        """
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

    def lose(self, why: Exception) -> bool:
        """Note that the main thread will not return; whether there is another one that then ends the process."""
        self.lost = why
        return self.is_entered

    def end_by_force(self, hanging: Exception, errors: Sequence[Exception]) -> None:
        """Ends the process if the main thread hangs; called by another one, which has released the outputs.

        A command ends at once, and so does a process that a signal should have ended, or whose main thread is lost;
        other processes end when a signal arrives. If a driver hangs, an output may not be safe.
        """
        lines = [f"stopped by {name_of_signal(self.signal)}"] if self.signal else []
        lines += [described(error) for error in (hanging, *errors)]
        # Writing may hang as well, if the main thread is in the middle of writing.
        writing = threading.Thread(target=self._write_out, args=(lines,), daemon=True)
        writing.start()
        writing.join(_AGAIN)
        if self.say is not None or self.signal or self.lost:
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
        """Surrounds all that a process does: signals that arrive afterwards have no effect.

        Otherwise a second signal could end the process by its default while the interpreter shuts down, and that would
        become its exit code. A signal that arrives a second later still ends a process that has not ended: a driver may
        have left a thread behind.
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
"""There is one for the process, as there is for the handlers of signals."""
