"""The examples of drivers in C: on a pseudo-terminal, and on a recording of events.

A CAN bus needs vcan, and GPIO a chip, both of the kernel; where there are none, the drivers are compiled, and report
what is missing.
"""

from __future__ import annotations

import os
import pty
import shutil
import socket
import struct
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from cspdiag.cli.main import main
from tests.c_kernel.building import need, run

EXAMPLES = Path(__file__).parents[2] / "examples" / "c" / "devices"
WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Wcast-qual", "-Werror")


@pytest.fixture
def example(tmp_path: Path) -> Callable[[str, str, str], list[str]]:
    """The command that runs an example with another device than in its text."""

    def command(name: str, device: str, other: str) -> list[str]:
        need("cc")
        folder = Path(shutil.copytree(EXAMPLES, tmp_path / "devices"))
        program = folder / f"{name}.csp"
        text = program.read_text(encoding="utf-8")
        assert f'"{device}"' in text
        program.write_text(text.replace(f'"{device}"', f'"{other}"'), encoding="utf-8")
        record = ["--record", str(tmp_path / "run.csv")]
        return ["run", str(program), "--target", "c", "--real-time", "--for", "700ms", *record]

    return command


def _column(file: Path, name: str) -> list[float]:
    rows = [line.split(",") for line in file.read_text().splitlines() if not line.startswith("#")]
    (at,) = [at for at, title in enumerate(rows[0]) if title.split(" ")[0].endswith(name)]
    return [float(row[at]) for row in rows[1:] if row[at]]


@pytest.mark.parametrize("name", ["serial", "can", "lines", "joystick"])
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_they_compile_without_a_warning(name: str, compiler: str, tmp_path: Path) -> None:
    need(compiler)
    run(compiler, "-std=c99", "-O2", *WARNINGS, "-c", EXAMPLES / f"{name}.c", "-o", tmp_path / "driver.o")


def test_serial(example: Callable[[str, str, str], list[str]], tmp_path: Path) -> None:
    master, slave = pty.openpty()
    command = example("serial", "/dev/ttyUSB0", os.ttyname(slave))
    ended = False
    sent: list[bytes] = []

    def board() -> None:
        os.set_blocking(master, False)
        while not ended:
            os.write(master, b"level 1.5\r\n")
            time.sleep(0.005)
            try:
                sent.append(os.read(master, 1000))
            except BlockingIOError:
                continue

    thread = threading.Thread(target=board)
    thread.start()
    try:
        assert main(command) == 0
        time.sleep(0.05)
    finally:
        ended = True
        thread.join()
        os.close(master)
        os.close(slave)
    lines = [line for line in b"".join(sent).split(b"\n") if line.startswith(b"valve")]
    assert b"valve 0.75" in lines
    assert lines[-1] == b"valve 0"
    assert set(_column(tmp_path / "run.csv", "level")) == {1.5}


def test_joystick(example: Callable[[str, str, str], list[str]], tmp_path: Path) -> None:
    """From a pipe with events as Linux writes them: EV_ABS 3, ABS_X 0."""
    pipe = tmp_path / "events"
    os.mkfifo(pipe)
    file = os.open(pipe, os.O_RDWR)
    moved = struct.pack("@llHHi", 0, 0, 3, 0, 16384)
    pressed = struct.pack("@llHHi", 0, 0, 1, 0x130, 1)
    os.write(file, moved + pressed)
    try:
        assert main(example("joystick", "/dev/input/by-id/usb-gamepad-event-joystick", str(pipe))) == 0
    finally:
        os.close(file)
    assert _column(tmp_path / "run.csv", "level")[-1] == pytest.approx(0.5, abs=1e-4)


@pytest.mark.parametrize(
    ("name", "device", "account"),
    [
        ("lines", "/dev/gpiochip0", "/dev/nothing: No such file or directory"),
        ("can", "can0", ""),
    ],
)
def test_a_device_that_is_not_there_is_reported_before_the_run(
    name: str,
    device: str,
    account: str,
    example: Callable[[str, str, str], list[str]],
    capfd: pytest.CaptureFixture[str],
) -> None:
    assert main(example(name, device, "/dev/nothing")) == 1
    shown = capfd.readouterr()
    assert account in shown.err
    assert f"the device {name} could not be opened" in shown.out + shown.err


def test_can(example: Callable[[str, str, str], list[str]], tmp_path: Path) -> None:
    try:
        bus = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
        bus.bind(("vcan0",))
    except OSError as error:
        pytest.skip(f"no virtual CAN bus vcan0: {error}")
    ended = False
    heard: list[bytes] = []

    def board() -> None:
        bus.settimeout(0.005)
        while not ended:
            bus.send(struct.pack("<IB3x8s", 0x100, 2, struct.pack("<h", 6)))
            try:
                heard.append(bus.recv(16))
            except TimeoutError:
                continue

    thread = threading.Thread(target=board)
    thread.start()
    try:
        assert main(example("can", "can0", "vcan0")) == 0
    finally:
        ended = True
        thread.join()
        bus.close()
    valves = [struct.unpack("<IB3xh", frame[:10])[2] for frame in heard]
    assert 3 in valves
    assert valves[-1] == 0
