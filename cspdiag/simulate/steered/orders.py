"""The orders for a steered program: the records of ``csp_steering.h``, in a pipe."""

from __future__ import annotations

import os
import struct
from contextlib import suppress

_ORDER = struct.Struct("=qIIII")
_ADVANCE, _STEP, _PAUSE, _TAKE, _GIVE_BACK, _REPORT = range(6)


class Orders:
    """Gives orders through a pipe, of which the program inherits ``descriptor``. Nothing happens if it has ended."""

    def __init__(self) -> None:
        self.descriptor, self._writing = os.pipe()

    def program_started(self) -> None:
        """Only the program reads the pipe from here on."""
        os.close(self.descriptor)
        self.descriptor = -1

    def advance(self, until: int) -> None:
        """Continue up to and including an instant in nanoseconds."""
        self._give(_ADVANCE, until)

    def step(self, until: int, communications: int) -> None:
        """The same, until that many values were communicated."""
        self._give(_STEP, until, communications)

    def pause(self) -> None:
        """Wait for orders."""
        self._give(_PAUSE)

    def take(self, port: int, value: bytes) -> None:
        """An input, by the number of its channel, has this value from the next instant on."""
        self._give(_TAKE, 0, port, value)

    def give_back(self, port: int) -> None:
        """The environment has the input again."""
        self._give(_GIVE_BACK, 0, port)

    def report(self) -> None:
        """Tell which processes wait."""
        self._give(_REPORT)

    def _give(self, kind: int, instant: int = 0, number: int = 0, value: bytes = b"") -> None:
        if self._writing < 0:
            return
        with suppress(BrokenPipeError):
            os.write(self._writing, _ORDER.pack(instant, kind, number, len(value), 0) + value)

    def close(self) -> None:
        """No order will follow: the run ends."""
        if self.descriptor >= 0:
            self.program_started()
        if self._writing >= 0:
            os.close(self._writing)
            self._writing = -1
