"""A process that works for another one ends with it, however that one ends.

It has the reading end of a pipe to which nothing is written any more, its lifeline; only the other process has the
writing end, which the system closes when that process ends.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator
from queue import SimpleQueue
from threading import Thread


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
