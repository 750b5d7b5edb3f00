"""A process that works for another one ends with it, however that one ends.

It has the reading end of a pipe to which nothing is written any more, its lifeline; only the other process has the
writing end, which the system closes when that process ends. Commands that threads of a process run end with it, too,
if it says so.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from queue import SimpleQueue
from threading import Lock, Thread
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import subprocess


def _terminate() -> None:
    os.kill(os.getpid(), signal.SIGTERM)


def end_with(lifeline: int, end: Callable[[], object] = _terminate) -> None:
    """Have this process end, as by SIGTERM, when the other end of a pipe is closed; ``lifeline`` is its descriptor, and
    ``end`` another way to end.
    """

    def wait() -> None:
        while os.read(lifeline, 1 << 10):
            pass
        end()

    _meanwhile(wait)


def lines_of_input() -> Iterator[str]:
    """The lines of standard input, without end: this process ends with that input, as by SIGTERM, whatever it is doing
    with a line.
    """
    lines: SimpleQueue[str] = SimpleQueue()

    def read() -> None:
        for line in sys.stdin:
            lines.put(line)
        _terminate()

    _meanwhile(read)
    while True:
        yield lines.get()


def _meanwhile(wait: Callable[[], None]) -> None:
    """Wait in a thread of its own."""
    thread = Thread(target=wait, name="lifeline", daemon=True)
    if not hasattr(signal, "pthread_sigmask"):
        thread.start()
        return
    # Signals are for the main thread, whose waits they end.
    before = signal.pthread_sigmask(signal.SIG_BLOCK, signal.valid_signals())
    try:
        thread.start()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def end_with_input() -> None:
    """The same with the pipe that is standard input, which is empty from then on."""
    lifeline = os.dup(0)
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    end_with(lifeline)


class RunningCommands:
    """Commands that run, in several threads, and that can be ended together; each is a group of processes, because it
    may start others.
    """

    def __init__(self) -> None:
        self._lock = Lock()
        self._running: set[subprocess.Popen[str]] = set()
        self._is_stopped = False

    def run(self, command: Sequence[str], environment: Mapping[str, str] | None) -> subprocess.CompletedProcess[str]:
        """Run one to its end. Raises OSError if it cannot be started, InterruptedError after ``stop``."""
        import subprocess

        with self._lock:
            if self._is_stopped:
                raise InterruptedError
            process = subprocess.Popen(
                command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment, process_group=0
            )
            self._running.add(process)
        try:
            output, errors = process.communicate()
        except BaseException:
            _kill(process)
            process.communicate()
            raise
        finally:
            self._running.discard(process)
        return subprocess.CompletedProcess(command, process.returncode, output, errors)

    def stop(self) -> None:
        """End all of them, and start no other one."""
        with self._lock:
            self._is_stopped = True
            for process in tuple(self._running):
                _kill(process)


def _kill(process: subprocess.Popen[str]) -> None:
    if process.returncode is None:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
