"""The terminal in whose foreground the server runs: its keys are those of the device "keyboard"."""

from __future__ import annotations

import os
from contextlib import suppress
from typing import Any


def _in_foreground() -> int | None:
    """The stream that is such a terminal."""
    for stream in (0, 1, 2):
        with suppress(OSError):
            if os.tcgetpgrp(stream) == os.getpgrp():
                return stream
    return None


class LentTerminal:
    """The terminal while an engine has it; one that is killed cannot give it back as it was."""

    def __init__(self) -> None:
        self._stream = _in_foreground()
        self._attributes: list[Any] = []
        if self._stream is not None:
            import termios

            self._attributes = termios.tcgetattr(self._stream)

    @property
    def variables(self) -> dict[str, str]:
        """The environment variables that tell an engine which terminal it is."""
        return {} if self._stream is None else {"CSPDIAG_TERMINAL": os.ttyname(self._stream)}

    def restore(self) -> None:
        """Set it as it was, unless the server is in the background now, where the terminal is that of others."""
        if self._stream is None or _in_foreground() != self._stream:
            return
        import termios

        with suppress(termios.error):
            termios.tcsetattr(self._stream, termios.TCSADRAIN, self._attributes)
