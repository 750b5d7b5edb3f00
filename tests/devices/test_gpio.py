"""The device "gpio", with gpiod's own settings and a chip that the test makes up.

A simulated chip, gpio-sim, needs a module of the kernel, which is not to be had where tests run in containers.
"""

from __future__ import annotations

import errno
import os
import threading
import time
from typing import Any

import pytest

import cspdiag

gpiod = pytest.importorskip("gpiod", reason="gpiod is not installed")

PROGRAM = """
driver Lines(button_line: int, lamp_line: int, bias: text = "pull_up", active_low: bool = true) device "gpio" {
  out button : bool
  in  lamp   : bool
}
process Main {
  in  button : bool @ 10 ms
  out lamp   : bool @ 10 ms safe false

  communication {
    var pressed : bool = false
  }
  composition {
    mu (button ? pressed ; lamp ! pressed)
  }
}
environment Bench for Main on miss count {
  lines : Lines(button_line = 17, lamp_line = 27)
  lines.button -> button
  lamp -> lines.lamp
}
"""


class _Chip:
    """What is behind a request of lines."""

    def __init__(self, path: str, consumer: str, config: dict[int, Any]) -> None:
        self.path = path
        self.config = config
        self.values: dict[int, Any] = dict.fromkeys(config, gpiod.line.Value.INACTIVE)
        self.written: list[tuple[int, bool]] = []
        self.released = False
        self.gone = False

    def get_value(self, line: int) -> Any:
        if self.gone:
            raise OSError(errno.ENODEV, "No such device")
        return self.values[line]

    def set_value(self, line: int, value: Any) -> None:
        assert self.config[line].direction == gpiod.line.Direction.OUTPUT
        self.written.append((line, value == gpiod.line.Value.ACTIVE))

    def release(self) -> None:
        self.released = True


@pytest.fixture
def chips(monkeypatch: pytest.MonkeyPatch) -> list[_Chip]:
    made: list[_Chip] = []

    def request_lines(path: str, consumer: str, config: dict[int, Any]) -> _Chip:
        made.append(_Chip(path, consumer, config))
        return made[-1]

    monkeypatch.setattr(gpiod, "request_lines", request_lines)
    return made


def _run(chips: list[_Chip], act: Any) -> Any:
    def script() -> None:
        while not chips:
            time.sleep(0.01)
        act(chips[0])

    thread = threading.Thread(target=script)
    thread.start()
    result = cspdiag.parse(PROGRAM).run(real_time=True, until="300 ms")
    thread.join()
    return result


def test_lines_are_read_and_written_and_the_output_is_released(chips: list[_Chip]) -> None:
    def press(chip: _Chip) -> None:
        time.sleep(0.1)
        chip.values[17] = gpiod.line.Value.ACTIVE

    result = _run(chips, press)
    (chip,) = chips
    assert result.outcome.ended == "time limit"
    assert (27, True) in chip.written
    assert chip.written[-1] == (27, False)
    assert chip.released
    assert chip.path == "/dev/gpiochip0"
    assert chip.config[17].bias == gpiod.line.Bias.PULL_UP
    assert chip.config[17].active_low
    assert chip.config[27].active_low


def test_a_chip_that_is_unplugged_ends_the_run(chips: list[_Chip]) -> None:
    result = _run(chips, lambda chip: setattr(chip, "gone", True))
    assert "DeviceError: the chip was unplugged: connect it and start again" in str(result.outcome.error)
    assert chips[0].written[-1] == (27, False)


@pytest.mark.parametrize(
    ("code", "account"),
    [
        (errno.EACCES, "no permission for /dev/gpiochip0: sudo usermod -aG gpio $USER, then log in again"),
        (errno.ENOENT, "there is no such chip (there are: "),
        (errno.EBUSY, "another program, or the kernel, uses one of the lines: gpioinfo shows which"),
        (errno.EINVAL, "the chip does not have one of the lines [17, 27]: see gpioinfo"),
    ],
)
def test_refused_lines_are_reported_before_the_run(code: int, account: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*given: Any, **options: Any) -> None:
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr(gpiod, "request_lines", refuse)
    result = cspdiag.parse(PROGRAM).run(real_time=True, until="1 s")
    assert result.outcome.time == 0
    assert f"driver gpio /dev/gpiochip0 failed to open at port Main.button: DeviceError: {account}" in str(
        result.outcome.error
    )


def test_an_unknown_bias_is_reported_before_the_run(chips: list[_Chip]) -> None:
    result = cspdiag.parse(PROGRAM.replace('"pull_up"', '"up"')).run(real_time=True, until="1 s")
    assert 'bias "up" is not as_is, pull_up, pull_down or disabled' in str(result.outcome.error)
