"""UDP: datagrams of JSON, or of C structures."""

from __future__ import annotations

import json
import socket
import struct
from collections.abc import Mapping, Sequence
from typing import Any

from .failure import DeviceError
from .messages import SECOND, MessageDevice, Receiver, Use, parsed, shortened


class Udp(MessageDevice):
    """Receives datagrams at ``port`` of the interface ``bind``, and sends to ``to``, a ``HOST:PORT`` (default: to where
    the last datagram came from).

    A datagram is a JSON object with some of the ports, ``{"x": 0.5, "stop": true}``; with ``out_format`` and
    ``in_format`` the outputs and the inputs in the order of their declaration, as the module ``struct`` packs them.
    """

    def __init__(
        self,
        outputs: Mapping[str, Use],
        inputs: Sequence[str],
        *,
        port: int = 0,
        bind: str = "127.0.0.1",
        to: str = "",
        out_format: str = "",
        in_format: str = "",
        patience: int = 10 * SECOND,
        timeout: int = 0,
    ) -> None:
        super().__init__(f"udp {bind}:{port}" if outputs else f"udp {to}", outputs, patience=patience, timeout=timeout)
        self._place = (bind, port)
        self._to = _place(to) if to else None
        self._answers = not to
        self._outputs = _Packed(out_format, outputs, "out_format") if out_format else None
        self._inputs = _Packed(in_format, inputs, "in_format") if in_format else None
        self._values: dict[str, Any] = dict.fromkeys(inputs, 0)
        self._socket: socket.socket | None = None
        self._receiver: Receiver | None = None

    def connect(self) -> None:
        """See ``MessageDevice.connect``."""
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.bind(self._place)
        except OSError as error:
            raise DeviceError(f"it cannot listen at {self._place[0]}:{self._place[1]}: {error.strerror}") from None
        self._socket.settimeout(0.1)
        self._receiver = Receiver(self, self._receive)

    def disconnect(self) -> None:
        """See ``MessageDevice.disconnect``."""
        if self._receiver is not None:
            self._receiver.stop()
        if self._socket is not None:
            self._socket.close()

    def _receive(self) -> None:
        assert self._socket is not None
        try:
            data, sender = self._socket.recvfrom(65536)
        except TimeoutError:
            return
        for port, value in self._unpacked(data).items():
            self.receive(port, value)
        if self._answers:
            self._to = sender

    def _unpacked(self, data: bytes) -> dict[str, Any]:
        if self._outputs is not None:
            return self._outputs.unpacked(data)
        try:
            values = parsed(data)
        except ValueError:
            values = None
        if not isinstance(values, dict):
            raise DeviceError(f'received {shortened(data)}, which is no JSON object such as {{"x": 0.5}}')
        return values

    def send(self, port: str, value: Any) -> None:
        """See ``MessageDevice.send``: a datagram with the port, or with all inputs if they have a format."""
        assert self._socket is not None
        if self._to is None:
            return  # Nobody has written yet who could be answered.
        self._values[port] = value
        data = self._inputs.packed(self._values) if self._inputs else json.dumps({port: value}).encode()
        self._socket.sendto(data, self._to)


class _Packed:
    """The values of ports as a structure."""

    def __init__(self, format_: str, ports: Mapping[str, Use] | Sequence[str], parameter: str) -> None:
        self._ports = tuple(ports)
        self._parameter = f'{parameter} "{format_}"'
        try:
            self._struct = struct.Struct(format_)
            count = len(self._struct.unpack(bytes(self._struct.size)))
        except struct.error as error:
            raise DeviceError(f"{self._parameter}: {error}") from None
        if count != len(self._ports):
            wanted = "one port" if len(self._ports) == 1 else f"{len(self._ports)} ports"
            raise DeviceError(f"{self._parameter} has {count} value{'s' * (count != 1)} for {wanted}")

    def unpacked(self, data: bytes) -> dict[str, Any]:
        """The values by port. Raises DeviceError for data of another size."""
        if len(data) != self._struct.size:
            raise DeviceError(f"received {len(data)} bytes instead of {self._struct.size}: {shortened(data)}")
        return dict(zip(self._ports, self._struct.unpack(data), strict=True))

    def packed(self, values: Mapping[str, Any]) -> bytes:
        """The values of all ports. Raises DeviceError for one that does not fit its place."""
        try:
            return self._struct.pack(*(values[port] for port in self._ports))
        except (struct.error, OverflowError) as error:
            listed = ", ".join(f"{port} = {values[port]!r}" for port in self._ports)
            raise DeviceError(f"{self._parameter} does not take {listed}: {error}; choose wider types") from None


def _place(text: str) -> tuple[str, int]:
    host, colon, number = text.rpartition(":")
    if not (colon and host and number.isdecimal() and int(number) < 1 << 16):
        raise DeviceError(f'"{text}" is not a HOST:PORT')
    return host, int(number)
