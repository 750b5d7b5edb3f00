"""The device "zenoh", with another peer on this machine."""

from __future__ import annotations

import json
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from cspdiag.devices.failure import DeviceError
from cspdiag.devices.zenoh import Zenoh
from tests.devices.echoing import DECLARED, Peer, converse, failure, program, run
from tests.simulate.hosts.proxy import Proxy

pytest.importorskip("zenoh", reason="eclipse-zenoh is not installed")

PARAMETERS = 'connect: text, multicast: bool = false, go_key: text = "tank/command", prefix: text = "tank"'
DRIVER = f'driver Peer({PARAMETERS}, timeout: time = 0 s) device "zenoh" {{ {DECLARED} }}'


def _endpoint() -> str:
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        return f"tcp/127.0.0.1:{unused.getsockname()[1]}"


@contextmanager
def _peer(endpoint: str) -> Iterator[Peer]:
    import zenoh

    config = zenoh.Config()
    config.insert_json5("scouting/multicast/enabled", "false")
    config.insert_json5("listen/endpoints", json.dumps([endpoint]))
    session = zenoh.open(config)

    def send(name: str, value: Any) -> None:
        session.put({"level": "tank/level", "go": "tank/command"}[name], str(value))

    peer = Peer(send)
    subscriber = session.declare_subscriber(
        "tank/valve", lambda sample: peer.heard.put(float(sample.payload.to_bytes()))
    )
    try:
        yield peer
    finally:
        subscriber.undeclare()
        session.close()


def _repeated(peer: Peer) -> None:
    """What was sent before the program had joined is lost."""
    deadline = time.monotonic() + 5
    while peer.heard.empty() and time.monotonic() < deadline:
        peer.send("level", 1.5)
        time.sleep(0.02)


def test_values_go_both_ways_and_the_output_is_released() -> None:
    endpoint = _endpoint()
    with _peer(endpoint) as peer:

        def script() -> None:
            _repeated(peer)
            converse(peer)()

        result = run(program(DRIVER, f'connect = "{endpoint}"'), script)
    assert result.outcome.ended == "terminated"
    assert not result.outcome.release_errors


def test_a_peer_that_falls_silent_ends_the_run() -> None:
    endpoint = _endpoint()
    with _peer(endpoint) as peer:
        text = program(DRIVER, f'connect = "{endpoint}", timeout = 300 ms')
        result = run(text, lambda: _repeated(peer))
    assert "DeviceError: no value of level has come for 0.3" in failure(result)


def test_a_network_that_cannot_be_joined_is_reported_before_the_run() -> None:
    endpoint = _endpoint()
    result = run(program(DRIVER, f'connect = "{endpoint}"'), lambda: None)
    assert result.outcome.time == 0
    assert "DeviceError: it cannot join the network" in failure(result)


def test_a_dead_link_is_named_when_the_last_values_cannot_leave() -> None:
    """As after a cable was pulled, when what waits to be sent is more than the system holds."""
    endpoint = _endpoint()
    with _peer(endpoint):
        proxy = Proxy(int(endpoint.rpartition(":")[2]), 0.0)
        device = Zenoh({}, ["valve"], connect=f"tcp/127.0.0.1:{proxy.port}", multicast=False, prefix="tank")
        device.open()
        proxy.fall_silent()
        for _ in range(3000):
            device.write("valve", [0.5] * 20)
        with pytest.raises(DeviceError, match="the link is dead, so the last values may not have arrived"):
            device.close()
        proxy.close()
