"""The line that is rewritten while a program runs on a terminal: simulated time, speed, and the mode of each part."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Sequence
from types import TracebackType
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from cspdiag.simulate.modes import ModeGroup
    from cspdiag.simulate.recorder import Recorder

_INTERVAL = 0.2


class Running(Protocol):
    """A program that runs."""

    @property
    def now(self) -> int:
        """The present instant in nanoseconds."""
        ...


class Progress:
    """Rewrites a line on standard error from a thread of its own, so that the run pays nothing for it.

    Used as a context manager around the run; ``attach`` is to be called when the network is there.
    """

    def __init__(self, recorder: Recorder, groups: Sequence[ModeGroup]) -> None:
        self._recorder = recorder
        self._groups = groups
        self._network: Running | None = None
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._show, name="progress", daemon=True)
        self._begin = time.monotonic()

    def attach(self, network: Running) -> None:
        """Tell what runs; its clock begins now."""
        self._network = network
        self._begin = time.monotonic()

    def __enter__(self) -> Progress:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._ended.set()
        self._thread.join()
        sys.stderr.write("\r\x1b[K")
        sys.stderr.flush()

    def _show(self) -> None:
        while not self._ended.wait(_INTERVAL):
            if self._network is not None:
                sys.stderr.write(f"\r\x1b[K{self.line()}")
                sys.stderr.flush()

    def line(self) -> str:
        """The text of the line at this moment."""
        simulated = self._network.now / 1e9 if self._network is not None else 0.0
        elapsed = time.monotonic() - self._begin
        speed = simulated / elapsed if elapsed > 0 else 0.0
        running = self._running()
        modes = "  ".join(
            f"{group.name}: {'+'.join(name for path, name in group.modes.items() if path in running) or 'ended'}"
            for group in self._groups
            if group.modes
        )
        return f"{simulated:8.2f} s  {speed:6.1f}x  {modes}"

    def _running(self) -> set[str]:
        while True:
            try:
                return set(self._recorder.running)
            except RuntimeError:
                # The scheduler's thread changed the dictionary meanwhile; the next look succeeds.
                continue
