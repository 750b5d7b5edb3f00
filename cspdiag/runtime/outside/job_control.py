"""Signals of job control suspend a process; one that drives a machine has to keep running."""

from __future__ import annotations

import signal


def stay_running(*, real_time: bool) -> None:
    """From now on output to a terminal (``stty tostop``, ``&``) does not suspend this process, nor does, in real time,
    Ctrl-Z or input from a terminal.

    A suspended process hands nothing over: the outputs of the machine would keep their last values. Handlers that were
    installed for these signals stay.
    """
    for name in ("SIGTTOU", "SIGTTIN", "SIGTSTP") if real_time else ("SIGTTOU",):
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, signal.SIG_IGN)
