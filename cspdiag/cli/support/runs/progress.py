"""The line that shows while a program runs: simulated time, speed, and the mode of each part.

On a terminal it is rewritten continuously, unless another job is using it; in a file or a pipe a new line is written
from time to time.
"""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Sequence
from types import TracebackType
from typing import TYPE_CHECKING, Protocol

from cspdiag.base.standard_streams import standard_error
from cspdiag.cli.support.terminal import put
from cspdiag.runtime.kernel.signals import left_to_the_main_thread

if TYPE_CHECKING:
    from cspdiag.simulate.record.modes import ModeGroup
    from cspdiag.simulate.record.recorder import Recorder

_INTERVAL = 0.2
_INTERVAL_OF_LINES = 10.0
_MOST_GROUPS = 8
"""Of more groups of modes the first are shown."""


class Running(Protocol):
    """A program that runs."""

    @property
    def now(self) -> int:
        """The present instant in nanoseconds."""
        ...


def is_in_foreground() -> bool:
    """Whether this process is in the foreground of the terminal of standard error."""
    try:
        return os.tcgetpgrp(standard_error().fileno()) == os.getpgrp()
    except (OSError, AttributeError):
        # The terminal does not control this process, or the system has no controlling terminals.
        return True


def _columns() -> int:
    """The width of the terminal: a longer line would continue on the next one, and be repeated below itself."""
    try:
        return os.get_terminal_size(standard_error().fileno()).columns or 80
    except OSError:
        return 80


class Progress:
    """Writes the line to standard error from a thread of its own, so the run is not slowed down.

    ``interval`` is in seconds. Used as a context manager around the run; ``attach`` must be called when the network
    exists.
    """

    def __init__(self, recorder: Recorder, groups: Sequence[ModeGroup], interval: float | None = None) -> None:
        self._is_terminal = standard_error().isatty()
        self._interval = interval or (_INTERVAL if self._is_terminal else _INTERVAL_OF_LINES)
        self._recorder = recorder
        self._groups = groups
        self._network: Running | None = None
        self._begun: set[str] = set()
        self._starts = 0
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._show, name="progress", daemon=True)
        self._begin = time.monotonic()
        self.written = 0
        """The number of times the line was written."""

    def attach(self, network: Running) -> None:
        """Attach the running program; its clock begins now."""
        self._network = network
        self._begin = time.monotonic()

    def __enter__(self) -> Progress:
        with left_to_the_main_thread():
            self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._ended.set()
        self._thread.join()
        if self._is_terminal and is_in_foreground():
            put("\r\x1b[K")

    def _show(self) -> None:
        while not self._ended.wait(self._interval):
            if self._network is None or (self._is_terminal and not is_in_foreground()):
                continue
            put(f"\r\x1b[K{self.line()[: _columns() - 1]}" if self._is_terminal else f"{self.line()}\n")
            self.written += 1

    def line(self) -> str:
        """The text of the line at this moment."""
        simulated = self._network.now / 1e9 if self._network is not None else 0.0
        elapsed = time.monotonic() - self._begin
        speed = simulated / elapsed if elapsed > 0 else 0.0
        running = self._running()
        self._note_started_processes()
        groups = [group for group in self._groups if group.modes]
        modes = [f"{group.name}: {self._mode(group, running)}" for group in groups[:_MOST_GROUPS]]
        if len(groups) > _MOST_GROUPS:
            modes.append(f"and {len(groups) - _MOST_GROUPS} more")
        return f"{simulated:8.2f} s  {speed:6.1f}x  {'  '.join(modes)}".rstrip()

    def _mode(self, group: ModeGroup, running: set[str]) -> str:
        """The processes of a group that are running."""
        present = "+".join(name for path, name in group.modes.items() if path in running)
        return present or ("not begun" if self._begun.isdisjoint(group.modes) else "ended")

    def _note_started_processes(self) -> None:
        new = self._recorder.activities[self._starts :]
        self._starts += len(new)
        self._begun.update(activity.path for activity in new)

    def _running(self) -> set[str]:
        while True:
            try:
                return set(self._recorder.running)
            except RuntimeError:
                # The scheduler's thread changed the dictionary meanwhile; the next look succeeds.
                continue
