"""Gamepads and joysticks, with pygame-ce."""

from __future__ import annotations

import glob
import os
import time
from typing import Any

from .failure import DeviceError, library, no_permission

_PERIOD = 1e-3
"""Seconds for which what SDL has reported is new enough."""


class Gamepad:
    """The gamepad with this index among those that are plugged in.

    Sticks and triggers are within -1 and 1, to the right and downwards positive; within ``dead_zone`` they are at rest.
    """

    needs_real_time = True

    def __init__(self, *, index: int = 0, dead_zone: float = 0.05) -> None:
        self.name = f"gamepad {index}"
        self._index = index
        self._dead_zone = dead_zone
        self._sdl: _Sdl | None = None
        self._pad: Any = None

    def open(self) -> None:
        """Find the gamepad. Raises DeviceError."""
        self._sdl = _Sdl()
        pads = self._sdl.names()
        if not 0 <= self._index < len(pads):
            self._sdl.close()
            raise _missing(pads)
        self._pad = self._sdl.joystick(self._index)

    def close(self) -> None:
        """Leave it to others."""
        if self._sdl is not None:
            self._pad.quit()
            self._sdl.close()

    def read(self, port: str) -> float | int | bool:
        """The present state of an output. Raises DeviceError if the gamepad is gone."""
        assert self._sdl is not None
        if not self._sdl.is_there(self._pad):
            raise DeviceError("it was unplugged, or its battery is empty: connect it and start again")
        match port:
            case "x" | "y":
                return self._axis("xy".index(port))
            case "hat_x" | "hat_y":
                hat = self._pad.get_hat(0) if self._pad.get_numhats() else (0, 0)
                return int(hat["xy".index(port[-1])])
            case "buttons":
                return sum(bool(self._pad.get_button(at)) << at for at in range(self._pad.get_numbuttons()))
            case _:  # Ports with a number, of which there are many; `button` is the first.
                if port.startswith("axis"):
                    return self._axis(int(port.removeprefix("axis")))
                return self._button(int(port.removeprefix("button") or "0"))

    def _axis(self, at: int) -> float:
        if at >= self._pad.get_numaxes():
            raise DeviceError(f"{self._pad.get_name()} has {self._pad.get_numaxes()} axes, and no axis{at}")
        value = min(max(float(self._pad.get_axis(at)), -1.0), 1.0)
        return 0.0 if abs(value) < self._dead_zone else value

    def _button(self, at: int) -> bool:
        if at >= self._pad.get_numbuttons():
            raise DeviceError(f"{self._pad.get_name()} has {self._pad.get_numbuttons()} buttons, and no button{at}")
        return bool(self._pad.get_button(at))


def found() -> list[str]:
    """What is plugged in. Raises DeviceError if pygame-ce is not installed, or there is no permission."""
    sdl = _Sdl()
    pads = sdl.names()
    sdl.close()
    if not pads and _unreadable():
        raise no_permission(_unreadable()[0], "input")
    return [f"index {at}: {name}" for at, name in enumerate(pads)]


def _missing(pads: list[str]) -> DeviceError:
    unreadable = _unreadable()
    if pads:
        return DeviceError(f"there is none with this index: {', '.join(f'{at} is {p}' for at, p in enumerate(pads))}")
    if unreadable:
        return no_permission(unreadable[0], "input")
    return DeviceError("none is plugged in: connect one and start again")


def _unreadable() -> list[str]:
    """Gamepads that Linux knows and this user may not read."""
    return [file for file in glob.glob("/dev/input/js*") if not os.access(file, os.R_OK)]


class _Sdl:
    """What pygame needs to see gamepads without a window; as many as there are in a program share it."""

    _users = 0
    _pumped = 0.0
    _removed: set[int] = set()  # noqa: RUF012 - shared by all, as SDL's events are

    def __init__(self) -> None:
        os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
        self._pygame = library("pygame", "pygame-ce", "gamepad")
        if not self._pygame.display.get_init():
            # Events of joysticks need SDL's video, but no screen.
            os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
            os.environ.setdefault("SDL_JOYSTICK_ALLOW_BACKGROUND_EVENTS", "1")
            self._pygame.display.init()
        self._pygame.joystick.init()
        self._pygame.event.set_allowed(None)
        self._pygame.event.set_allowed(self._pygame.JOYDEVICEREMOVED)
        _Sdl._users += 1

    def close(self) -> None:
        """Called once by each user."""
        _Sdl._users -= 1
        if not _Sdl._users:
            self._pygame.joystick.quit()
            self._pygame.display.quit()

    def names(self) -> list[str]:
        """The names of those that are plugged in, by index."""
        self._pygame.event.pump()
        return [self.joystick(at).get_name() for at in range(self._pygame.joystick.get_count())]

    def joystick(self, index: int) -> Any:
        """The joystick with this index."""
        return self._pygame.joystick.Joystick(index)

    def is_there(self, pad: Any) -> bool:
        """Brings the state up to date. Whether a joystick is still plugged in."""
        now = time.monotonic()
        if now - _Sdl._pumped >= _PERIOD:
            _Sdl._pumped = now
            for event in self._pygame.event.get(self._pygame.JOYDEVICEREMOVED):
                _Sdl._removed.add(event.instance_id)
        return pad.get_instance_id() not in _Sdl._removed
