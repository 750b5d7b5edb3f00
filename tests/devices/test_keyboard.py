"""The device "keyboard", with a pseudo-terminal as its terminal."""

from __future__ import annotations

import os
import pty
import termios
import threading
import time
from collections.abc import Iterator

import pytest

import cspdiag
from cspdiag.simulate.result import Run

PROGRAM = """
driver Keys(path: text) device "keyboard" {
  out x, y : double
  out space : bool
  out key : int
  out buttons : int
}
process Main {
  in  x, y     : double @ 10 ms
  in  space    : bool
  in  key      : int    @ 10 ms
  in  buttons  : int    @ 10 ms
  out position : double @ 10 ms safe -9

  communication {
    var across : double = 0
    var down   : double = 0
    var pushed : bool   = false
    var code   : int    = 0
    var mask   : int    = 0
  }
  composition {
    mu (
      space ? pushed -> skip
      []>
      x ? across -> (y ? down ; key ? code ; buttons ? mask ; position ! across + 10 * down)
    ) until pushed
  }
}
submodel Arm { in u : double  out angle : double  angle = u }
environment Bench for Main on miss count {
  keys : Keys(path = "PATH")
  arm  : Arm
  keys.x -> x  keys.y -> y  keys.space -> space  keys.key -> key  keys.buttons -> buttons
  position -> arm.u
}
"""


@pytest.fixture
def terminal() -> Iterator[tuple[int, str]]:
    master, slave = pty.openpty()
    try:
        yield master, os.ttyname(slave)
    finally:
        os.close(master)
        os.close(slave)


def _wait_until_opened(master: int) -> None:
    """Then the terminal does not echo any more."""
    while termios.tcgetattr(master)[3] & termios.ECHO:
        time.sleep(0.01)
    time.sleep(0.1)


def _run(terminal: tuple[int, str], keys: list[bytes], until: str = "5 s") -> Run:
    """Types the keys as soon as the terminal does not echo any more."""
    master, path = terminal

    def type_() -> None:
        _wait_until_opened(master)
        for key in keys:
            os.write(master, key)
            time.sleep(0.05)

    thread = threading.Thread(target=type_)
    thread.start()
    result = cspdiag.parse(PROGRAM.replace("PATH", path)).run(real_time=True, until=until)
    thread.join()
    return result


def test_keys_reach_the_program_and_the_terminal_is_given_back(terminal: tuple[int, str]) -> None:
    before = termios.tcgetattr(terminal[0])
    result = _run(terminal, [b"\x1b[C", b"\x1b[C\x1bOA", b"a", b"2", b"\x1b[5~", b" "])
    assert result.outcome.ended == "terminated"
    assert result["x"][-1] == 0.2
    assert result["y"][-1] == -0.1
    assert ord("a") in result["key"].tolist()
    assert set(result["buttons"].tolist()) == {0, 2}
    assert result["position"][-1] == -9
    assert termios.tcgetattr(terminal[0]) == before


def test_a_letter_of_several_bytes_is_one_key(terminal: tuple[int, str]) -> None:
    result = _run(terminal, ["é".encode(), b" "])
    assert set(result["key"].tolist()) <= {0, ord("é"), ord(" ")}
    assert ord("é") in result["key"].tolist()


def test_home_returns_the_stick_and_it_has_an_end(terminal: tuple[int, str]) -> None:
    result = _run(terminal, [b"\x1b[D" * 12, b"\x1b[H", b" "])
    assert min(result["x"]) == -1
    assert result["x"][-1] == 0


def test_a_key_is_released_after_a_while(terminal: tuple[int, str]) -> None:
    result = _run(terminal, [b"b", b"", b"", b"", b"", b"", b" "])
    codes = result["key"].tolist()
    assert 0 in codes[codes.index(ord("b")) :]


def test_a_missing_terminal_is_reported_before_the_run() -> None:
    result = cspdiag.parse(PROGRAM.replace("PATH", "/dev/null")).run(real_time=True, until="1 s")
    assert result.outcome.time == 0
    assert "driver keyboard failed to open at port Main.x: DeviceError: there is no terminal at /dev/null" in str(
        result.outcome.error
    )


def test_a_terminal_that_is_closed_ends_the_run() -> None:
    master, slave = pty.openpty()
    path = os.ttyname(slave)
    os.close(slave)

    def close() -> None:
        _wait_until_opened(master)
        os.close(master)

    closing = threading.Thread(target=close)
    closing.start()
    result = cspdiag.parse(PROGRAM.replace("PATH", path)).run(real_time=True, until="5 s")
    closing.join()
    assert "DeviceError: its terminal was closed" in str(result.outcome.error)
    assert result["position"][-1] == -9
