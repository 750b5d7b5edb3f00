"""Signals of job control stop a process and leave it there; one that drives a machine has to go on."""

from __future__ import annotations

import signal


def stay_running(*, real_time: bool) -> None:
    """From now on no output to a terminal stops this process (``stty tostop``, ``&``), nor, against the clock, does
    Ctrl-Z or input from a terminal.

    A process that is stopped hands nothing over: the outputs of the machine would keep their last values. What somebody
    has decided about these signals stays.
    """
    for name in ("SIGTTOU", "SIGTTIN", "SIGTSTP") if real_time else ("SIGTTOU",):
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, signal.SIG_IGN)
