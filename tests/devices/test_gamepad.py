"""The device "gamepad", with SDL's virtual joystick."""

from __future__ import annotations

import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

pytest.importorskip("pygame", reason="pygame-ce is not installed")

ROOT = Path(__file__).parents[2]

VIRTUAL = '''
import ctypes, glob, os, sys, threading, time

os.environ["SDL_VIDEODRIVER"] = "dummy"
os.environ["PYGAME_HIDE_SUPPORT_PROMPT"] = "1"
import pygame

(library,) = glob.glob(os.path.join(os.path.dirname(pygame.__file__), "..", "pygame_ce.libs", "libSDL2-2*"))
sdl = ctypes.CDLL(library)
sdl.SDL_JoystickOpen.restype = ctypes.c_void_p
pygame.display.init()
pygame.joystick.init()


class Stick:
    """A joystick of SDL that exists in this process only."""

    def __init__(self, axes=4, buttons=12):
        self.index = sdl.SDL_JoystickAttachVirtual(1, axes, buttons, 1)
        self.handle = ctypes.c_void_p(sdl.SDL_JoystickOpen(self.index))

    def axis(self, at, value):
        sdl.SDL_JoystickSetVirtualAxis(self.handle, at, ctypes.c_int16(round(value * 32767)))

    def button(self, at, value):
        sdl.SDL_JoystickSetVirtualButton(self.handle, at, ctypes.c_uint8(value))

    def unplug(self):
        sdl.SDL_JoystickDetachVirtual(self.index)


began = threading.Event()
get_events = pygame.event.get


def get(*given):
    began.set()
    return get_events(*given)


pygame.event.get = get


def at(seconds, *actions):
    """Acts so long after the first read."""
    def act():
        began.wait()
        time.sleep(seconds)
        for action in actions:
            action()
    threading.Thread(target=act, daemon=True).start()


'''

PROGRAM = """
driver Pad device "gamepad" { out x, axis3 : double  out button : bool  out hat_y : int  out buttons : int }
process Main {
  in  x, axis3 : double @ 5 ms
  in  button   : bool
  in  hat_y    : int    @ 5 ms
  in  buttons  : int    @ 5 ms
  out position : double @ 5 ms safe -1

  communication {
    var across  : double = 0
    var other   : double = 0
    var pressed : bool   = false
    var hat     : int    = 0
    var mask    : int    = 0
  }
  composition {
    mu (
      button ? pressed -> skip
      []>
      x ? across -> (axis3 ? other ; hat_y ? hat ; buttons ? mask ; position ! across + other)
    ) until pressed
  }
}
submodel Mirror { in u : double  out y : double  y = u }
environment Bench for Main on miss count {
  pad : Pad
  mirror : Mirror
  position -> mirror.u
  pad.x -> x  pad.axis3 -> axis3  pad.button -> button  pad.hat_y -> hat_y  pad.buttons -> buttons
}
"""


def _run(script: str, *, errors: bool = False) -> str:
    """What a process with a virtual joystick prints, with its standard error or without any; SDL belongs to the
    process.
    """
    text = VIRTUAL + f"import cspdiag\nPROGRAM = {PROGRAM!r}\n" + textwrap.dedent(script)
    result = subprocess.run(
        [sys.executable, "-c", text], capture_output=True, text=True, timeout=60, cwd=ROOT, check=False
    )
    assert errors or not result.stderr, result.stderr
    return result.stderr + result.stdout


def test_sticks_and_buttons_reach_the_program() -> None:
    shown = _run(
        """
        stick = Stick()
        stick.axis(0, 0.5)
        stick.axis(3, -1)
        stick.axis(1, 0.01)
        at(0.2, lambda: stick.button(1, 1), lambda: stick.button(3, 1))
        at(0.4, lambda: stick.button(0, 1))
        run = cspdiag.parse(PROGRAM).run(real_time=True, until="5 s")
        masks = set(run["buttons"].tolist())
        print(run.outcome.ended, {0, 10} <= masks <= {0, 2, 10, 11}, run["x"][0].round(3), run["axis3"][-1].round(3))
        """
    )
    assert shown == "terminated True 0.5 -1.0\n"


def test_one_that_is_unplugged_ends_the_run_with_its_outputs_released() -> None:
    shown = _run(
        """
        stick = Stick()
        at(0.2, stick.unplug)
        run = cspdiag.parse(PROGRAM).run(real_time=True, until="5 s")
        print(run.outcome.error)
        print(run["position"][-1])
        """
    )
    first, second = shown.splitlines()
    assert first.startswith("driver gamepad 0 failed to read at port Main.")
    assert first.endswith("DeviceError: it was unplugged, or its battery is empty: connect it and start again")
    assert second == "-1.0"


def test_one_without_a_port_that_is_read_ends_the_run() -> None:
    shown = _run(
        """
        stick = Stick(axes=2)
        print(cspdiag.parse(PROGRAM).run(real_time=True, until="1 s").outcome.error)
        """
    )
    assert shown.endswith("read at port Main.axis3: DeviceError: Virtual Controller has 2 axes, and no axis3\n")


@pytest.mark.parametrize(
    ("script", "account"),
    [
        ("", "none is plugged in: connect one and start again"),
        (
            "stick = Stick(); PROGRAM = PROGRAM.replace('Pad dev', 'Pad(index: int = 2) dev')",
            "there is none with this index: 0 is Virtual Controller",
        ),
    ],
)
def test_one_that_does_not_fit_is_reported_before_the_run(script: str, account: str) -> None:
    shown = _run(
        script
        + """
run = cspdiag.parse(PROGRAM).run(real_time=True, until="1 s")
print(run.outcome.time, run.outcome.error)
"""
    )
    assert shown.startswith("0 ")
    assert shown.endswith(f"DeviceError: {account}\n")


def test_jiwy_runs_in_real_time_with_a_gamepad_in_one_command() -> None:
    """The joints look for their end stops (faster than usual), follow the stick, and stop at the second button."""
    shown = _run(
        """
        from cspdiag.cli.main import main

        stick = Stick()
        stick.axis(0, 0.3)
        at(3, lambda: stick.button(1, 1))
        faster = [word for joint in ("horizontal", "vertical") for word in ("--set", f"{joint}.alignSpeed=3")]
        command = ["run", "models/jiwy/jiwy.csp", "--environment", "Gamepad", "--real-time", "--for", "15 s"]
        print(main([*command, *faster]))
        """,
        errors=True,
    )
    assert "Jiwy in Gamepad: ended by itself at 3" in shown
    assert "motionControl until 3" in shown
    assert shown.endswith("\n0\n")


def test_one_without_permission_names_the_group(monkeypatch: pytest.MonkeyPatch) -> None:
    """For root, who may read all, by what the file system says."""
    from cspdiag.devices import gamepad

    monkeypatch.setattr(gamepad.glob, "glob", lambda pattern: ["/dev/input/js0"])
    monkeypatch.setattr(gamepad.os, "access", lambda file, mode: False)
    assert str(gamepad._missing([])) == (
        "no permission for /dev/input/js0: sudo usermod -aG input $USER, then log in again"
    )


def test_plugged_in_gamepads_are_listed() -> None:
    shown = _run(
        """
        from cspdiag.cli.main import main

        stick = Stick()
        main(["devices", "gamepad"])
        """
    )
    assert shown.endswith("plugged in:\n  index 0: Virtual Controller\n")
