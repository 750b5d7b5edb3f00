"""What signals do to a process that is writing files: those that end it neither cut a result in two nor leave anything
beside it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

_ENDING = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGBREAK", "SIGIO")
"""Those that end commands. Ctrl-C is the first, so it is held for longest: it raises an exception wherever it arrives.
The last one is how a command asks a server to stop.
"""


@contextmanager
def signals_held() -> Iterator[None]:
    """Within it, signals wait; they have their effect when it ends. For what takes well under a second."""
    arrived: list[int] = []
    try:
        with _handled(lambda number, _: arrived.append(number), only_default=False):
            yield
    finally:
        _raise(arrived)


@contextmanager
def signals_raised() -> Iterator[None]:
    """Within it, signals that would end this process at once raise an exception, as Ctrl-C does, so that what is
    unfinished can be removed; they end the process when it ends.
    """
    arrived: list[int] = []
    begun = False

    def end(number: int, _: FrameType | None) -> None:
        arrived.append(number)
        if begun and len(arrived) == 1:
            raise _EndedBySignal

    try:
        with _handled(end, only_default=True):
            begun = True
            if arrived:
                raise _EndedBySignal
            try:
                yield
            finally:
                begun = False  # Handlers are taken out; an exception would leave the others.
    finally:
        _raise(arrived[:1])


class _EndedBySignal(BaseException):
    """Nobody sees it but the code that removes what is unfinished."""


@contextmanager
def _handled(handler: Callable[[int, FrameType | None], object], *, only_default: bool) -> Iterator[None]:
    """A handler of the signals that are not ignored; in other threads than the main one there is none, and no signal
    raises anything there.
    """
    import signal

    before: dict[int, Any] = {}
    try:
        for name in _ENDING:
            number = getattr(signal, name, None)
            known = number and signal.getsignal(number)
            if number is None or not (known is signal.SIG_DFL or (callable(known) and not only_default)):
                continue
            before[number] = known
            try:
                signal.signal(number, handler)
            except ValueError:
                del before[number]
                break
        yield
    finally:
        for number in reversed(before):
            signal.signal(number, before[number])


def _raise(numbers: list[int]) -> None:
    import signal

    for number in numbers:
        signal.raise_signal(number)
