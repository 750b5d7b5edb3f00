"""Which signals end a process unless they are handled, and their names."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager

_OTHERS = (
    "SIGKILL", "SIGSTOP",
    "SIGCHLD", "SIGCONT", "SIGTSTP", "SIGTTIN", "SIGTTOU", "SIGURG", "SIGWINCH", "SIGINFO",
    "SIGSEGV", "SIGBUS", "SIGFPE", "SIGILL", "SIGEMT",
)  # fmt: skip
"""Those that cannot be handled; those that end no process; and faults of the processor: a handler in Python runs only
after the instruction has succeeded, so the processor would repeat it forever.
"""

SIGNALS: frozenset[int] = frozenset(
    int(number)
    for number in signal.valid_signals()
    if not (isinstance(number, signal.Signals) and number.name in _OTHERS)
)
"""Those that end a process by default, and that a process can handle; real-time signals too. Python ignores SIGPIPE and
SIGXFSZ from the start.
"""


def exit_code_of(number: int) -> int:
    """What a shell reports for a program that a signal has ended: 128 and the signal, 130 for Ctrl-C."""
    return 128 + number


def name_of_signal(number: int) -> str:
    """The name of a signal as people write it."""
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"SIGRTMIN+{number - signal.SIGRTMIN}"


@contextmanager
def left_to_the_main_thread() -> Iterator[None]:
    """A thread that is started within it receives no signals.

    Handlers in Python run in the main thread. Where the system hands a signal to another thread, the main one is not
    woken: it would notice the signal only when what it waits for has arrived.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
