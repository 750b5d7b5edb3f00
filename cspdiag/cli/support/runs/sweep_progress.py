"""The line that shows while a sweep is planned and runs: how much is done, and how long the rest takes."""

from __future__ import annotations

import time

from cspdiag.base.standard_streams import standard_error
from cspdiag.cli.support.runs.progress import is_in_foreground
from cspdiag.cli.support.terminal import put

_INTERVAL = 0.2


class _Line:
    """A line of standard error that changes, if that is a terminal."""

    def __init__(self) -> None:
        self._due = 0.0
        self._shown = False
        self._is_terminal = standard_error().isatty()

    def _is_due(self, now: float) -> bool:
        due = now >= self._due
        if due:
            self._due = now + _INTERVAL
        return due

    def _show(self, text: str) -> None:
        if self._is_terminal and is_in_foreground():
            put(f"\r\x1b[K{text}")
            self._shown = True

    def close(self) -> None:
        """Remove the line."""
        if self._shown:
            put("\r\x1b[K")
            self._shown = False


class PlanProgress(_Line):
    """Which part of the combinations of values has a program, before the runs."""

    def __init__(self) -> None:
        super().__init__()
        self._began = time.monotonic()

    def planned(self, known: int, total: int) -> None:
        """The programs of ``known`` combinations of ``total`` are known."""
        now = time.monotonic()
        if self._is_due(now):
            self._show(self.line(known, total, now - self._began))

    def line(self, known: int, total: int, elapsed: float) -> str:
        """The text of the line after some seconds."""
        return f"comparing equations: {known} of {total} combinations, {_shown(elapsed / known * (total - known))} left"


class SweepProgress(_Line):
    """How many runs are done: ``total`` are to be made, and ``known`` already are."""

    def __init__(self, total: int, known: int) -> None:
        super().__init__()
        self._total = total
        self._known = known
        self._done = known
        self._began: float | None = None

    def building(self, number: int, count: int) -> None:
        """A program is being built."""
        which = f" {number + 1} of {count}" if count > 1 else ""
        self._show(f"building the program{which} ...")

    def done(self) -> None:
        """One more run is known."""
        now = time.monotonic()
        self._began = now if self._began is None else self._began
        self._done += 1
        if self._is_due(now):
            self._show(self.line(now - self._began))

    def line(self, elapsed: float) -> str:
        """The text of the line after some seconds."""
        made = self._done - self._known
        left = self._total - self._done
        rest = f", {_shown(elapsed / made * left)} left" if elapsed > 0 and made > 1 else ""
        return f"{self._done} of {self._total} run{'s' if self._total != 1 else ''}{rest}"


def _shown(seconds: float) -> str:
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    minutes, rest = divmod(whole, 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes} min" if hours else f"{minutes} min {rest} s"
