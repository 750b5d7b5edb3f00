"""The device "mqtt", with a broker that the test starts."""

from __future__ import annotations

import shutil
import socket
import subprocess
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from tests.devices.echoing import DECLARED, Peer, converse, failure, program, run

pytest.importorskip("paho.mqtt", reason="paho-mqtt is not installed")
BROKER = shutil.which("mosquitto") or shutil.which("mosquitto", path="/usr/sbin")
needs_broker = pytest.mark.skipif(BROKER is None, reason="mosquitto is not installed")

PARAMETERS = 'port: int, level_topic: text = "tank/level", prefix: text = "tank", patience: time = 10 s'
DRIVER = f'driver Peer({PARAMETERS}) device "mqtt" {{ {DECLARED} }}'


def _free_port() -> int:
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        return int(unused.getsockname()[1])


@contextmanager
def _broker(folder: Path, anonymous: str = "true") -> Iterator[tuple[int, subprocess.Popen[bytes]]]:
    assert BROKER is not None
    port = _free_port()
    (folder / "broker.conf").write_text(f"listener {port} 127.0.0.1\nallow_anonymous {anonymous}\n")
    broker = subprocess.Popen([BROKER, "-c", str(folder / "broker.conf")], stderr=subprocess.DEVNULL)
    try:
        for _ in range(200):
            with socket.socket() as probe:
                if probe.connect_ex(("127.0.0.1", port)) == 0:
                    break
            time.sleep(0.02)
        yield port, broker
    finally:
        broker.terminate()
        broker.wait()


@contextmanager
def _peer(port: int) -> Iterator[Peer]:
    """A client with retained levels, so that the program has one at once."""
    import paho.mqtt.client as paho

    client = paho.Client(paho.CallbackAPIVersion.VERSION2)
    subscribed = threading.Event()

    def send(name: str, value: Any) -> None:
        plain = name.removesuffix("/retained")
        sent = client.publish(f"tank/{plain}", str(value), qos=1, retain=name in ("level", "go/retained"))
        sent.wait_for_publish(5)  # The broker has it.

    peer = Peer(send)
    client.on_message = lambda client, data, message: peer.heard.put(float(message.payload))
    client.on_subscribe = lambda *_: subscribed.set()
    client.connect("127.0.0.1", port)
    client.subscribe("tank/valve")
    client.loop_start()
    assert subscribed.wait(5)
    try:
        yield peer
    finally:
        client.disconnect()
        client.loop_stop()


@needs_broker
def test_values_go_both_ways_and_the_output_is_released(tmp_path: Path) -> None:
    with _broker(tmp_path) as (port, _), _peer(port) as peer:
        result = run(program(DRIVER, f"port = {port}"), converse(peer))
    assert result.outcome.ended == "terminated"
    assert not result.outcome.release_errors


@needs_broker
def test_a_broker_that_goes_away_ends_the_run(tmp_path: Path) -> None:
    with _broker(tmp_path) as (port, broker), _peer(port) as peer:

        def script() -> None:
            peer.send("level", 1.5)
            peer.expect(1.5)
            broker.terminate()

        result = run(program(DRIVER, f"port = {port}"), script)
    assert f"driver mqtt localhost:{port} failed to" in failure(result)
    assert "DeviceError: the broker has gone away" in failure(result)


@needs_broker
def test_nonsense_is_reported_at_its_port(tmp_path: Path) -> None:
    with _broker(tmp_path) as (port, _), _peer(port) as peer:

        def script() -> None:
            peer.send("level", 1.5)
            peer.expect(1.5)
            peer.send("go", "on")
            peer.expect(-1)

        result = run(program(DRIVER, f"port = {port}"), script)
    assert failure(result).endswith("failed to read at port Main.go: TypeError: 'on' is no integer")


@needs_broker
def test_what_the_broker_retained_is_a_sample_but_no_event(tmp_path: Path) -> None:
    with _broker(tmp_path) as (port, _), _peer(port) as peer:
        peer.send("level", 1.5)
        peer.send("go/retained", 2)

        def script() -> None:
            peer.expect(1.5)
            time.sleep(0.1)
            peer.send("go", 9)
            peer.expect(-1)

        result = run(program(DRIVER, f"port = {port}"), script)
    assert result.outcome.ended == "terminated"
    assert set(peer.values) == {1.5, -1.0}


@needs_broker
def test_a_refused_user_is_reported_before_the_run(tmp_path: Path) -> None:
    with _broker(tmp_path, anonymous="false") as (port, _):
        result = run(program(DRIVER, f"port = {port}"), lambda: None)
    assert "the broker refuses: Not authorized; see `user` and MQTT_PASSWORD" in failure(result)


def test_a_broker_that_is_not_there_is_reported_before_the_run() -> None:
    result = run(program(DRIVER, f"port = {_free_port()}"), lambda: None)
    assert result.outcome.time == 0
    assert failure(result).endswith("there is no broker: Connection refused; start one, or correct `host`")
