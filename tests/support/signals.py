"""Signals of the process that runs tests."""

from __future__ import annotations

import signal


def hear_signals() -> None:
    """What a script starts with & ignores SIGINT and SIGQUIT, with nohup SIGHUP, and so would everything that it starts
    in turn.
    """
    for number in (signal.SIGINT, signal.SIGQUIT, signal.SIGHUP):
        if signal.getsignal(number) is signal.SIG_IGN:
            signal.signal(number, signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL)
