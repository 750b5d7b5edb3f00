"""``run --serve``: a client of the Foxglove protocol sees the values of the run."""

from __future__ import annotations

import asyncio
import json
import re
import socket
import struct
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from cspdiag.cli.main import main
from tests.simulate.record.streamed.test_ends import LOOP

pytest.importorskip("foxglove")
websockets = pytest.importorskip("websockets")


@pytest.fixture
def program(tmp_path: Path) -> Path:
    path = tmp_path / "main.csp"
    path.write_text(LOOP.replace("1 ms", "10 ms").replace("for Main", "for Main on miss count"))
    return path


def started(program: Path, *options: str) -> tuple[subprocess.Popen[bytes], int]:
    """The run, and the port that it listens to."""
    command = [sys.executable, "-m", "cspdiag", "run", str(program), "--serve", "0", *options]
    process = subprocess.Popen(command, stderr=subprocess.PIPE)
    assert process.stderr is not None
    line = process.stderr.readline().decode()
    found = re.search(r"ws://127\.0\.0\.1:(\d+)", line)
    assert found, line + process.stderr.read().decode()
    return process, int(found[1])


async def seen(port: int, least: int) -> tuple[dict[str, Any], list[tuple[int, float]]]:
    """What is advertised, and some values of ``level``."""
    values: list[tuple[int, float]] = []
    place = f"ws://127.0.0.1:{port}"
    async with websockets.connect(place, subprotocols=["foxglove.sdk.v1"], close_timeout=0.2) as client:
        channels: dict[str, Any] = {}
        while len(channels) < 2:
            message = await client.recv()
            if isinstance(message, str) and (found := json.loads(message))["op"] == "advertise":
                channels |= {channel["topic"]: channel for channel in found["channels"]}
        wanted = {"id": 7, "channelId": channels["/level"]["id"]}
        await client.send(json.dumps({"op": "subscribe", "subscriptions": [wanted]}))
        while len(values) < least:
            message = await client.recv()
            if isinstance(message, bytes) and message[0] == 1:
                number, instant = struct.unpack_from("<IQ", message, 1)
                assert number == 7
                values.append((instant, struct.unpack("<d", message[17:])[0]))
    return channels, values


@pytest.mark.parametrize("options", [[], ["--target", "c"], ["-O0"]], ids=" ".join)
def test_a_client_sees_the_values_in_order(program: Path, options: list[str]) -> None:
    process, port = started(program, "--real-time", "--quiet", *options)
    try:
        channels, values = asyncio.run(asyncio.wait_for(seen(port, 50), 60))
        # A client that has gone away costs the next one nothing.
        _, more = asyncio.run(asyncio.wait_for(seen(port, 20), 60))
    finally:
        process.terminate()
        process.communicate()
    assert channels["/level"]["schemaName"] == "std_msgs/msg/Float64"
    assert channels["/level"]["encoding"] == "cdr"
    instants = [instant for instant, _ in values]
    assert instants == sorted(set(instants))
    assert all(instant % 10_000_000 == 0 and abs(value - instant / 1e9) < 1e-9 for instant, value in values)
    assert more[0][0] > values[-1][0]


def test_what_clients_do_wrong_is_said_once_a_kind(program: Path) -> None:
    process, port = started(program, "--real-time", "--quiet")
    try:
        for _ in range(3):
            with socket.create_connection(("127.0.0.1", port), 10) as nonsense:
                nonsense.sendall(b"\xff\xfe nonsense\r\n\r\n")
                nonsense.recv(100)
            with pytest.raises(websockets.exceptions.InvalidHandshake):
                asyncio.run(asyncio.wait_for(asked(port, "foxglove.websocket.v1"), 60))
            asyncio.run(asyncio.wait_for(asked(port, "foxglove.sdk.v1", '{"op": "nonsense"}'), 60))
            killed = socket.create_connection(("127.0.0.1", port), 10)
            killed.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            killed.close()
        asyncio.run(asyncio.wait_for(seen(port, 5), 60))
    finally:
        process.terminate()
        _, said = process.communicate()
    lines = said.decode().splitlines()
    assert all(line.startswith("cspdiag: --serve: ") for line in lines), lines
    assert len(lines) == len(set(lines)), lines
    assert any("`foxglove.sdk.v1`" in line for line in lines), lines
    assert any("not understood" in line for line in lines), lines


async def asked(port: int, protocol: str, *messages: str) -> None:
    """A client that asks for a protocol, and sends something."""
    async with websockets.connect(f"ws://127.0.0.1:{port}", subprotocols=[protocol], close_timeout=0.2) as client:
        await client.recv()
        for message in messages:
            await client.send(message)


def test_a_client_that_does_not_read_delays_nothing(program: Path) -> None:
    process, port = started(program, "--for", "300s")
    with socket.create_connection(("127.0.0.1", port)):
        text = process.communicate(timeout=30)[1].decode()
    assert process.returncode == 0
    assert "reached the time limit at 300 s" in text


def test_a_run_to_which_nobody_connects_ends_as_ever(program: Path, capsys: pytest.CaptureFixture[str]) -> None:
    recording = program.parent / "run.csv"
    assert main(["run", str(program), "--serve", "0", "--for", "2s", "--record", str(recording)]) == 0
    assert len(recording.read_text().splitlines()) == 201


def test_a_port_that_is_taken_is_reported(program: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        number = taken.getsockname()[1]
        assert main(["run", str(program), "--serve", str(number), "--for", "1s"]) == 2
    said = capsys.readouterr().err
    assert f"--serve 127.0.0.1:{number}: Failed to bind port: " in said
    assert said.endswith("; choose an address of this machine and a free port\n")


@pytest.mark.parametrize("place", ["main.csp", "70000", "host:", ":80"])
def test_what_is_no_port_is_refused(program: Path, place: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", str(program), "--serve", place]) == 2
    assert "a port, or HOST:PORT" in capsys.readouterr().err
