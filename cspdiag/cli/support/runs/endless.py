"""Prints one line on standard error if a run that never ends by itself has continued for a while."""

from __future__ import annotations

import threading
from types import TracebackType
from typing import TYPE_CHECKING

from cspdiag.base.standard_streams import standard_error
from cspdiag.cli.support.terminal import put
from cspdiag.network.checks.endless import never_ends
from cspdiag.network.ir.network import Network
from cspdiag.runtime.kernel.signals import left_to_the_main_thread

if TYPE_CHECKING:
    from cspdiag.cli.support.runs.standstill import RunningNetwork

PATIENCE = 1.0
"""Seconds within which a run that deadlocks or fails has usually ended."""


class EndlessRun:
    """Used as a context manager around a run without a time limit; says how to end it if it is still running
    ``patience`` seconds after ``attach``, and if it is certain that the program never ends by itself.
    """

    def __init__(self, network: Network, patience: float | None = None) -> None:
        self._name = network.class_named(network.top).definition
        self._patience = PATIENCE if patience is None else patience
        self._is_endless = bool(network.environments) and never_ends(network)
        self._running: RunningNetwork | None = None
        self._ended = threading.Event()
        self.thread = threading.Thread(target=self._wait, name="endless run", daemon=True)

    def attach(self, running: RunningNetwork | None = None) -> None:
        """The program runs from now on; without ``running`` it is over when the context is left."""
        self._running = running
        if self._is_endless:
            with left_to_the_main_thread():
                self.thread.start()

    def __enter__(self) -> EndlessRun:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._ended.set()
        if self.thread.is_alive():
            self.thread.join()

    def _wait(self) -> None:
        if not self._ended.wait(self._patience) and (self._running is None or not self._running.over):
            # A line of progress may be there.
            clear = "\r\x1b[K" if standard_error().isatty() else ""
            ends = "Ctrl-C ends the run, --for 20s would end it at 20 s"
            put(f"{clear}cspdiag: {self._name} never ends by itself: {ends}\n")
