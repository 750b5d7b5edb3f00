"""The device "opcua", with a server that the test starts."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Iterator
from typing import Any

import pytest

from tests.devices.echoing import DECLARED, Peer, converse, failure, program, run

pytest.importorskip("asyncua", reason="asyncua is not installed")

NODES = 'level_node: text = "ns=2;s=Level", go_node: text = "ns=2;s=Go", valve_node: text = "ns=2;s=Valve"'
DRIVER = f'driver Peer(url: text, {NODES}) device "opcua" {{ {DECLARED} }}'


def _free_port() -> int:
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        return int(unused.getsockname()[1])


class _Server(Peer):
    """A server with three variables."""

    def __init__(self, url: str) -> None:
        from asyncua import ua
        from asyncua.sync import Server

        super().__init__(self._set)
        self.argument = f'url = "{url}"'
        self.server = Server()
        self.server.set_endpoint(url)
        self.server.set_security_policy([ua.SecurityPolicyType.NoSecurity])
        self.server.register_namespace("tank")
        objects = self.server.nodes.objects
        self.variables = {
            "level": objects.add_variable(ua.NodeId("Level", 2), "Level", 1.5),
            "go": objects.add_variable(ua.NodeId("Go", 2), "Go", 0),
            "valve": objects.add_variable(ua.NodeId("Valve", 2), "Valve", 0.0),
        }
        small = objects.add_variable(ua.NodeId("Small", 2), "Small", 0, ua.VariantType.Int16)
        for variable in (self.variables["valve"], small):
            variable.set_writable()
        self.server.start()
        self.ended = False
        self.thread = threading.Thread(target=self._watch)
        self.thread.start()

    def _set(self, name: str, value: Any) -> None:
        self.variables[name].write_value(value)

    def _watch(self) -> None:
        """Values of the valve that have changed."""
        last = 0.0
        while not self.ended:
            value = self.variables["valve"].read_value()
            if value != last:
                last = value
                self.heard.put(value)
            time.sleep(0.005)

    def stop(self) -> None:
        if not self.ended:
            self.ended = True
            self.thread.join()
            self.server.stop()


@pytest.fixture(scope="module")
def servers() -> Iterator[list[_Server]]:
    """The server, which takes seconds to make; a test that stops it leaves none."""
    made: list[_Server] = []
    yield made
    for server in made:
        server.stop()


@pytest.fixture
def server(servers: list[_Server]) -> _Server:
    if not servers or servers[-1].ended:
        servers.append(_Server(f"opc.tcp://127.0.0.1:{_free_port()}"))
    server = servers[-1]
    for name, value in {"level": 1.5, "go": 0, "valve": 0.0}.items():
        server.variables[name].write_value(value)
    while not server.heard.empty():
        server.heard.get()
    return server


def test_values_go_both_ways_and_the_output_is_released(server: _Server) -> None:
    result = run(program(DRIVER, server.argument), converse(server))
    assert result.outcome.ended == "terminated"
    assert not result.outcome.release_errors


def test_a_variable_that_the_server_does_not_have_is_reported_before_the_run(server: _Server) -> None:
    result = run(program(DRIVER.replace("s=Level", "s=Levle"), server.argument), lambda: None)
    assert result.outcome.time == 0
    assert "DeviceError: level_node: the server has no variable ns=2;s=Levle" in failure(result)


def test_a_bad_status_ends_the_run_and_is_named(server: _Server) -> None:
    from asyncua import ua

    bad = ua.DataValue(ua.Variant(None), ua.StatusCode(ua.StatusCodes.BadSensorFailure))
    try:
        server.variables["level"].write_value(bad)
        result = run(program(DRIVER, server.argument), lambda: None, until="3 s")
    finally:
        server.variables["level"].write_value(1.5)
    assert "DeviceError: ns=2;s=Level has no value: its status is BadSensorFailure" in failure(result)


def test_a_status_that_becomes_bad_ends_the_run_and_is_named(server: _Server) -> None:
    from asyncua import ua

    def script() -> None:
        server.expect(1.5)
        value = ua.DataValue(ua.Variant(3.0, ua.VariantType.Double), ua.StatusCode(ua.StatusCodes.BadSensorFailure))
        server.variables["level"].write_value(value)
        server.expect(-1)

    try:
        result = run(program(DRIVER, server.argument), script)
    finally:
        server.variables["level"].write_value(1.5)
    assert "DeviceError: ns=2;s=Level has no value: its status is BadSensorFailure" in failure(result)


def test_a_server_that_does_not_answer_is_reported() -> None:
    with socket.socket() as silent:
        silent.bind(("127.0.0.1", 0))
        silent.listen()
        url = f"opc.tcp://127.0.0.1:{silent.getsockname()[1]}"
        result = run(program(DRIVER, f'url = "{url}"'), lambda: None)
    assert "DeviceError: there is no server: it does not answer; start it, or correct `url`" in failure(result)


def test_a_value_that_its_variable_cannot_have_ends_the_run(server: _Server) -> None:
    server.variables["level"].write_value(45000.0)
    result = run(program(DRIVER.replace("s=Valve", "s=Small"), server.argument), lambda: None, until="3 s")
    assert "DeviceError: ns=2;s=Small cannot be written: " in failure(result)


def test_a_server_that_is_not_there_is_reported_before_the_run() -> None:
    result = run(program(DRIVER, f'url = "opc.tcp://127.0.0.1:{_free_port()}"'), lambda: None)
    assert result.outcome.time == 0
    assert "DeviceError: there is no server" in failure(result)


def test_a_server_that_goes_away_ends_the_run(server: _Server) -> None:
    def script() -> None:
        server.expect(1.5)
        server.stop()

    result = run(program(DRIVER, server.argument), script)
    assert "driver opcua opc.tcp://127.0.0.1" in failure(result)
    assert "DeviceError: " in failure(result)
