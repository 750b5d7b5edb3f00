"""The device "serial", with a pseudo-terminal as its board."""

from __future__ import annotations

import os
import pty
import select
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import pytest

from tests.devices.echoing import DECLARED, Peer, converse, failure, program, run

pytest.importorskip("serial", reason="pyserial is not installed")

DRIVER = f'driver Peer(path: text, patience: time = 10 s) device "serial" {{ {DECLARED} }}'


class _Board:
    """What is at the other end of a pseudo-terminal."""

    def __init__(self) -> None:
        self.master, slave = pty.openpty()
        self.path = os.ttyname(slave)
        os.close(slave)
        self.ended = False
        self.peer = Peer(lambda name, value: self.send(f"{name} {value}\n".encode()))

    def send(self, data: bytes) -> None:
        os.write(self.master, data)

    def unplug(self) -> None:
        self.ended = True
        os.close(self.master)
        self.master = -1

    def listen(self) -> None:
        begun = b""
        while not self.ended:
            with suppress(OSError, ValueError):  # EIO while nobody has opened the other end.
                if select.select([self.master], [], [], 0.05)[0]:
                    *lines, begun = (begun + os.read(self.master, 1000)).split(b"\n")
                    for line in lines:
                        self.peer.heard.put(float(line.removeprefix(b"valve ")))
                    continue
            time.sleep(0.01)


@contextmanager
def _board() -> Iterator[_Board]:
    board = _Board()
    thread = threading.Thread(target=board.listen)
    thread.start()
    try:
        yield board
    finally:
        board.ended = True
        thread.join()
        if board.master >= 0:
            os.close(board.master)


def _repeated(board: _Board) -> None:
    """A board sends all the time: what came before the line was opened is lost."""
    deadline = time.monotonic() + 30  # The program is compiled meanwhile.
    while board.peer.heard.empty() and time.monotonic() < deadline:
        board.send(b"# a board\nlevel 1.5\n")
        time.sleep(0.02)


def _run(board: _Board, script: Callable[[], Any]) -> Any:
    def after_the_first() -> None:
        _repeated(board)
        script()

    return run(program(DRIVER, f'path = "{board.path}"'), after_the_first)


def test_values_go_both_ways_and_the_output_is_released() -> None:
    with _board() as board:
        result = _run(board, converse(board.peer))
    assert result.outcome.ended == "terminated"


def test_an_infinity_is_a_value_as_printf_writes_it() -> None:
    with _board() as board:

        def script() -> None:
            board.send(b"level -inf\n")
            board.peer.expect(-1)

        result = _run(board, script)
    assert failure(result).startswith("a real value is infinite or not a number")


def test_nonsense_ends_the_run_with_its_outputs_released() -> None:
    with _board() as board:
        result = _run(board, lambda: board.send(b"\xff\xfe\x00~~\n"))
        board.peer.expect(-1)
    assert failure(result).endswith("which is no line `NAME VALUE`: does the board have 115200 baud?")


def test_a_wrong_type_is_reported_at_its_port() -> None:
    with _board() as board:
        result = _run(board, lambda: board.send(b"go now\n"))
    assert failure(result).endswith("failed to read at port Main.go: TypeError: 'now' is no integer")


def test_one_that_is_unplugged_ends_the_run() -> None:
    with _board() as board:
        result = _run(board, board.unplug)
    assert "DeviceError: it was unplugged, or the board is off" in failure(result)
    assert result.outcome.release_errors


def test_one_that_is_not_there_is_reported_before_the_run() -> None:
    result = run(program(DRIVER, 'path = "/dev/ttyNothing"'), lambda: None)
    assert result.outcome.time == 0
    assert "driver serial /dev/ttyNothing failed to open at port" in failure(result)
    assert "DeviceError: it is not there: plug it in" in failure(result)


def test_no_permission_names_the_group(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """For root, who may do everything, by what the library raises."""
    import serial

    def refuse(*given: Any, **options: Any) -> Any:
        raise serial.SerialException(13, "could not open port /dev/ttyUSB0: Permission denied")

    monkeypatch.setattr(serial, "Serial", refuse)
    result = run(program(DRIVER, 'path = "/dev/ttyUSB0"'), lambda: None)
    assert failure(result).endswith("no permission for /dev/ttyUSB0: sudo usermod -aG dialout $USER, then log in again")


def test_one_that_another_program_uses_is_reported() -> None:
    import serial

    with _board() as board, serial.Serial(board.path, exclusive=True):
        result = run(program(DRIVER, f'path = "{board.path}"'), lambda: None)
    assert failure(result).endswith("DeviceError: another program uses it: close that first")
