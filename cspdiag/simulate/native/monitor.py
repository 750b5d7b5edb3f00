"""The present state of a native program, as observed by a thread of its own."""

from __future__ import annotations

import os
import threading
import time

from cspdiag.runtime.kernel.signals import left_to_the_main_thread


class ProgramMonitor:
    """Reads lines ``7000000 Ring.cell[3] (ring.csp:12)`` from a pipe: the instant in nanoseconds and, if it is that of
    the previous line, which process is running.

    Used as a context manager around the run. The program inherits ``descriptor``, which never blocks it; ``started`` is
    called when it has.
    """

    def __init__(self) -> None:
        self._reading, self.descriptor = os.pipe()
        os.set_blocking(self.descriptor, False)
        self._thread = threading.Thread(target=self._read, name="monitor of the native program", daemon=True)
        self._began = time.monotonic()
        self._running_processes: dict[str, None] = {}
        self.now = 0
        """The instant of the last observation, in nanoseconds."""

    @property
    def wall_time(self) -> float:
        """Seconds since the program was started."""
        return time.monotonic() - self._began

    @property
    def running_processes(self) -> list[str]:
        """The processes that were found running since the present instant began, each with its place."""
        # A copy in one step, because the thread continues meanwhile.
        return list(self._running_processes)

    def started(self) -> None:
        """Note that the program has started; from here on only it can write."""
        os.close(self.descriptor)
        self.descriptor = -1
        self._began = time.monotonic()
        with left_to_the_main_thread():
            self._thread.start()

    def __enter__(self) -> ProgramMonitor:
        return self

    def __exit__(self, *_: object) -> None:
        if self.descriptor >= 0:
            os.close(self.descriptor)
        else:
            self._thread.join()
        os.close(self._reading)

    def _read(self) -> None:
        with os.fdopen(self._reading, "r", encoding="utf-8", errors="replace", closefd=False) as lines:
            for line in lines:
                instant, _, text = line.rstrip("\n").partition(" ")
                if int(instant) != self.now:
                    self._running_processes = {}
                self.now = int(instant)
                if text:
                    self._running_processes[text] = None
