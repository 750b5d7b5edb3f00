"""The device "can", with python-can's bus of multicast datagrams, and a DBC file."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from tests.devices.echoing import DECLARED, Peer, converse, failure, program, run

can = pytest.importorskip("can", reason="python-can is not installed")
cantools = pytest.importorskip("cantools", reason="cantools is not installed")
pytest.importorskip("msgpack", reason="msgpack, which the bus by multicast needs, is not installed")

DBC = """VERSION ""

NS_ :

BS_:

BU_: Board Program

BO_ 256 Status: 8 Board
 SG_ Level : 0|16@1- (0.25,0) [-8192|8191.75] "mm" Program
 SG_ Temperature : 16|8@1- (1,0) [-128|127] "degC" Program

BO_ 257 Command: 1 Board
 SG_ Go : 0|8@1+ (1,0) [0|255] "" Program

BO_ 512 Actuate: 4 Program
 SG_ Valve : 0|16@1- (0.25,0) [-8192|8191.75] "" Board
 SG_ Counter : 16|8@1+ (1,0) [0|255] "" Board
"""

PARAMETERS = (
    'dbc: text, interface: text = "udp_multicast", bus: text, level_signal: text = "Status.Level", '
    'go_signal: text = "Go", valve_signal: text = "Valve", timeout: time = 0 s'
)
DRIVER = f'driver Peer({PARAMETERS}) device "can" {{ {DECLARED} }}'
GROUP = f"239.74.163.{os.getpid() % 200 + 10}"


@pytest.fixture
def arguments(tmp_path: Path) -> str:
    (tmp_path / "tank.dbc").write_text(DBC)
    return f'dbc = "{tmp_path / "tank.dbc"}", bus = "{GROUP}"'


@contextmanager
def _board(folder: Path) -> Iterator[tuple[Peer, Any]]:
    database = cantools.database.load_file(folder / "tank.dbc")
    try:
        bus = can.Bus(interface="udp_multicast", channel=GROUP)
    except OSError as error:
        pytest.skip(f"no multicast on this machine: {error}")
    state = {"Level": 0.0, "Temperature": 20}

    def send(name: str, value: Any) -> None:
        if name == "level":
            state["Level"] = value
            data = database.encode_message("Status", state)
            bus.send(can.Message(arbitration_id=256, is_extended_id=False, data=data))
        else:
            bus.send(can.Message(arbitration_id=257, is_extended_id=False, data=bytes([value])))

    peer = Peer(send)
    ended = False

    def listen() -> None:
        while not ended:
            frame = bus.recv(0.05)
            if frame is not None and frame.arbitration_id == 512:
                peer.heard.put(database.decode_message(512, frame.data)["Valve"])

    thread = threading.Thread(target=listen)
    thread.start()
    try:
        yield peer, bus
    finally:
        ended = True
        thread.join()
        bus.shutdown()


def _repeated(peer: Peer) -> None:
    deadline = time.monotonic() + 30  # The program is compiled meanwhile.
    while peer.heard.empty() and time.monotonic() < deadline:
        peer.send("level", 1.5)
        time.sleep(0.02)


def test_values_go_both_ways_and_the_output_is_released(tmp_path: Path, arguments: str) -> None:
    with _board(tmp_path) as (peer, _):

        def script() -> None:
            _repeated(peer)
            converse(peer)()

        result = run(program(DRIVER, arguments), script)
    assert result.outcome.ended == "terminated"
    assert not result.outcome.release_errors


def test_a_frame_that_is_too_short_ends_the_run_with_its_outputs_released(tmp_path: Path, arguments: str) -> None:
    with _board(tmp_path) as (peer, bus):

        def script() -> None:
            _repeated(peer)
            bus.send(can.Message(arbitration_id=256, is_extended_id=False, data=b"\x01"))
            peer.expect(-1)

        result = run(program(DRIVER, arguments), script)
    assert f"driver can {GROUP} failed to" in failure(result)
    assert "DeviceError: received 01, which is no message Status" in failure(result)


def test_a_remote_frame_is_ignored(tmp_path: Path, arguments: str) -> None:
    with _board(tmp_path) as (peer, bus):

        def script() -> None:
            _repeated(peer)
            bus.send(can.Message(arbitration_id=256, is_extended_id=False, is_remote_frame=True, dlc=8))
            converse(peer)()

        result = run(program(DRIVER, arguments), script)
    assert result.outcome.ended == "terminated"


def test_a_file_of_another_kind_is_named(tmp_path: Path, arguments: str) -> None:
    (tmp_path / "tank.py").write_text("")
    result = run(program(DRIVER, arguments.replace("tank.dbc", "tank.py")), lambda: None)
    assert "tank.py is not a file that cantools reads: " in failure(result)


def test_a_value_that_its_signal_cannot_have_ends_the_run(tmp_path: Path, arguments: str) -> None:
    with _board(tmp_path) as (peer, _):

        def script() -> None:
            _repeated(peer)
            peer.send("go", 255)
            for _ in range(50):
                peer.send("level", 8191.75)
                time.sleep(0.02)

        result = run(program(DRIVER, arguments), script)
    assert "failed to write at port Main.valve: DeviceError: 8446.75 does not fit the signal Valve" in failure(result)


@pytest.mark.parametrize(
    ("changed", "account"),
    [
        (('"Go"', '"Start"'), "tank.dbc has no signal Start; it has Counter, Go, Level, Temperature, Valve"),
        (('"udp_multicast"', '"socketcan"'), ""),
    ],
)
def test_what_does_not_fit_is_reported_before_the_run(changed: tuple[str, str], account: str, arguments: str) -> None:
    driver = DRIVER.replace(*changed)
    result = run(program(driver, arguments.replace(GROUP, "can7")), lambda: None)
    assert result.outcome.time == 0
    assert account in failure(result)
    assert account or "there is no can7" in failure(result) or "this system has no CAN" in failure(result)


def test_a_file_that_is_not_there_is_reported_before_the_run() -> None:
    result = run(program(DRIVER, 'dbc = "nothing.dbc", bus = "can0"'), lambda: None)
    assert "nothing.dbc: No such file or directory; paths are relative to where the run starts" in failure(result)
