"""The device "udp", with a real socket as its peer."""

from __future__ import annotations

import json
import socket
import struct
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

import cspdiag
from cspdiag.devices.failure import DeviceError
from cspdiag.devices.udp import Udp
from tests.devices.echoing import DECLARED, Peer, converse, failure, program, run

PARAMETERS = (
    'port: int, to: text = "", out_format: text = "", in_format: text = "", patience: time = 10 s, timeout: time = 0 s'
)
DRIVER = f'driver Peer({PARAMETERS}) device "udp" {{ {DECLARED} }}'


def _free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as unused:
        unused.bind(("127.0.0.1", 0))
        return int(unused.getsockname()[1])


class _Socket:
    """A socket that sends to a port, and gives the valve's values to a peer."""

    def __init__(self, port: int) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        self.socket.settimeout(0.05)
        self.port = port
        self.ended = False

    def send(self, data: bytes) -> None:
        self.socket.sendto(data, ("127.0.0.1", self.port))

    def listen(self, peer: Peer) -> None:
        while not self.ended:
            try:
                data = self.socket.recv(1000)
            except TimeoutError:
                continue
            peer.heard.put(json.loads(data)["valve"] if data.startswith(b"{") else struct.unpack("<d", data)[0])


@contextmanager
def _peer(packed: bool = False) -> Iterator[tuple[Peer, int]]:
    port = _free_port()
    other = _Socket(port)
    state: dict[str, Any] = {"level": 0, "go": 0}

    def send(name: str, value: Any) -> None:
        if not packed:
            other.send(json.dumps({name: value}).encode())
            return
        state[name] = value
        other.send(struct.pack("<dh", state["level"], state["go"]))

    peer = Peer(send)
    thread = threading.Thread(target=other.listen, args=(peer,))
    thread.start()
    try:
        yield peer, port
    finally:
        other.ended = True
        thread.join()
        other.socket.close()


def _repeated(peer: Peer, port: str, value: float) -> None:
    """UDP loses what is sent before the program listens."""
    deadline = time.monotonic() + 5
    while peer.heard.empty() and time.monotonic() < deadline:
        peer.send(port, value)
        time.sleep(0.02)


@pytest.mark.parametrize("formats", [(), ("<dh", "<d")])
def test_values_go_both_ways_and_the_output_is_released(formats: tuple[str, ...]) -> None:
    with _peer(packed=bool(formats)) as (peer, port):
        arguments = f"port = {port}"
        if formats:
            arguments += f', out_format = "{formats[0]}", in_format = "{formats[1]}"'

        def script() -> None:
            _repeated(peer, "level", 1.5)
            converse(peer)()

        result = run(program(DRIVER, arguments), script)
    assert result.outcome.ended == "terminated"
    assert not result.outcome.release_errors


def test_equal_messages_are_events_each_time() -> None:
    """Unlike what is polled, which has to change."""
    text = """
driver Peer(port: int) device "udp" { out go : int }
process Main {
  in  go : int
  communication { var command : int = 0 }
  composition { go ? command ; go ? command ; go ? command }
}
environment Bench for Main { peer : Peer(port = PORT)  peer.go -> go }
"""
    with _peer() as (peer, port):

        def script() -> None:
            for _ in range(100):
                peer.send("go", 2)
                time.sleep(0.01)

        result = run(text.replace("PORT", str(port)), script)
    assert result.outcome.ended == "terminated"


def test_a_peer_that_is_not_there_is_reported_before_the_run() -> None:
    text = program(DRIVER, f"port = {_free_port()}, patience = 50 ms")
    result = run(text, lambda: None)
    assert result.outcome.time == 0
    assert "failed to open at port Main.level: DeviceError: no value of level has come within 0.05 s" in failure(result)


def test_a_misspelt_name_is_reported_with_those_that_came() -> None:
    with _peer() as (peer, port):
        text = program(DRIVER, f"port = {port}, patience = 2 s")
        result = run(text, lambda: [(peer.send("levle", 1), time.sleep(0.02)) for _ in range(50)] and None)
    assert failure(result).endswith("no value of level has come within 2 s; without a port there were levle")


@pytest.mark.parametrize(
    ("data", "account"),
    [
        (b"hello", """: DeviceError: received b'hello', which is no JSON object such as {"x": 0.5}"""),
        (b'{"level": "high"}', "failed to read at port Main.level: TypeError: 'high' is not a number"),
        (b'{"go": 0.5}', "failed to read at port Main.go: TypeError: 0.5 is no integer"),
        (b'{"level": ' + 3000 * b"[", """[[[[[..., which is no JSON object such as {"x": 0.5}"""),
        (b'{"level": ' + 900 * b"[" + 900 * b"]" + b"}", "Main.level: TypeError: [[[[[[[...]]]]]]] is not a number"),
        (b'{"level": ' + 400 * b"1" + b"}", "Main.level: Fault: LONG is too large for double precision"),
        (b'{"go": "' + 5000 * b"x" + b'"}', "TypeError: 'TEXT' is no integer"),
    ],
)
def test_nonsense_ends_the_run_with_its_outputs_released(data: bytes, account: str) -> None:
    with _peer() as (peer, port):

        def script() -> None:
            _repeated(peer, "level", 1.5)
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
                other.bind(("127.0.0.1", 0))
                other.sendto(data, ("127.0.0.1", port))

        result = run(program(DRIVER, f"port = {port}"), script)
    account = account.replace("LONG", f"{18 * '1'}...{19 * '1'}").replace("TEXT", f"{27 * 'x'}...{28 * 'x'}")
    assert failure(result).endswith(account)
    assert result["valve"][-1] == -1


def test_a_peer_that_falls_silent_ends_the_run() -> None:
    with _peer() as (peer, port):
        text = program(DRIVER, f"port = {port}, timeout = 200 ms")
        result = run(text, lambda: _repeated(peer, "level", 1.5))
    assert "no value of level has come for 0.2" in failure(result)


def test_a_format_that_does_not_fit_its_ports_is_refused_before_the_run() -> None:
    text = program(DRIVER, 'port = 0, out_format = "<ddd"')
    with pytest.raises(cspdiag.BodyError, match='out_format "<ddd" has 3 values for 2 ports'):
        cspdiag.parse(text).run(real_time=True, until="1 s")


def test_a_value_that_does_not_fit_its_place_in_a_structure_is_refused() -> None:
    device = Udp({}, ["valve"], to="127.0.0.1:9", in_format="<f")
    device.open()
    try:
        with pytest.raises(DeviceError, match=r'in_format "<f" does not take valve = 1e\+300: .*; choose wider types'):
            device.write("valve", 1e300)
    finally:
        device.close()


def test_it_refuses_virtual_time() -> None:
    result = cspdiag.parse(program(DRIVER, "port = 0")).run(until="1 s")
    assert failure(result).endswith(
        "failed to open at port Main.level: ValueError: it needs real time; on the command line: --real-time"
    )
