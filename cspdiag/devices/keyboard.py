"""The keyboard of a terminal, with the standard library of Python on Linux and macOS."""

from __future__ import annotations

import codecs
import errno
import os
import re
import time
from typing import Any

from .failure import DeviceError
from .messages import MILLISECOND, SECOND

_KEYS = re.compile(r"\x1b[\[O][0-9;]*([@-~])|\x1b|([^\x1b])")
"""The sequence of an arrow, Home or another special key by its last letter, or a key with a character."""
_OWN = "/dev/tty"
"""The terminal of the process. Of one that has none, because another process started it for a terminal, the environment
variable ``CSPDIAG_TERMINAL`` names it.
"""
_ARROWS = {"A": ("y", -1), "B": ("y", 1), "C": ("x", 1), "D": ("x", -1)}


class Keyboard:
    """The keys that are pressed in the terminal ``path``.

    A terminal reports presses and repetitions, but no releases: a key counts as pressed for ``hold`` nanoseconds after
    its last report. Arrows move ``x`` and ``y`` by ``step``, as a stick would be, and Home or 0 return them.
    """

    needs_real_time = True

    def __init__(self, *, path: str = _OWN, hold: int = 200 * MILLISECOND, step: float = 0.1) -> None:
        self.name = "keyboard"
        self._path = os.environ.get("CSPDIAG_TERMINAL", path) if path == _OWN else path
        self._hold = hold / SECOND
        self._step = step
        self._position = {"x": 0.0, "y": 0.0}
        self._pressed: dict[int, float] = {}
        self._file = -1
        self._decoder = codecs.getincrementaldecoder("utf-8")("ignore")
        self._before: list[Any] = []

    def open(self) -> None:
        """Take the keys from the terminal, without echo. Raises DeviceError."""
        try:
            import termios
            import tty
        except ImportError:
            raise DeviceError("it needs a terminal of Linux or macOS") from None
        try:
            self._file = os.open(self._path, os.O_RDONLY | os.O_NONBLOCK | os.O_NOCTTY)
            self._before = termios.tcgetattr(self._file)
            tty.setcbreak(self._file)
        except (OSError, termios.error) as error:
            if self._file >= 0:
                os.close(self._file)
            reason = os.strerror(error.args[0])
            raise DeviceError(f"there is no terminal at {self._path} ({reason}): start the program in one") from None

    def close(self) -> None:
        """Give the terminal back as it was."""
        import termios

        try:
            termios.tcsetattr(self._file, termios.TCSADRAIN, self._before)
        finally:
            os.close(self._file)

    def read(self, port: str) -> float | int | bool:
        """The present state of an output. Raises DeviceError if the terminal is gone."""
        self._take(self._typed())
        match port:
            case "x" | "y":
                return self._position[port]
            case "key":
                held = [key for key in self._pressed if self._is_held(key)]
                return held[-1] if held else 0
            case "buttons":
                return sum(self._is_held(ord("1") + at) << at for at in range(9))
            case _:  # The keys that have a port of their own.
                return self._is_held({"space": ord(" "), "enter": ord("\n")}[port])

    def _typed(self) -> str:
        try:
            data = os.read(self._file, 1000)
        except BlockingIOError:
            return ""
        except OSError as error:
            if error.errno != errno.EIO:
                raise
            data = b""
        if not data:
            raise DeviceError("its terminal was closed")
        return self._decoder.decode(data)

    def _take(self, typed: str) -> None:
        for found in _KEYS.finditer(typed):
            arrow, key = found.groups()
            if arrow in _ARROWS:
                axis, direction = _ARROWS[arrow]
                moved = self._position[axis] + direction * self._step
                self._position[axis] = round(min(max(moved, -1.0), 1.0), 9)
            elif arrow == "H" or key == "0":
                self._position = {"x": 0.0, "y": 0.0}
            elif key:
                self._pressed.pop(ord(key), None)  # The last one that was pressed is at the end.
                self._pressed[ord(key)] = time.monotonic()

    def _is_held(self, key: int) -> bool:
        return time.monotonic() - self._pressed.get(key, -self._hold) < self._hold
