"""Serial lines: boards behind a UART or USB, with pyserial."""

from __future__ import annotations

import errno
import re
from collections.abc import Mapping, Sequence
from typing import Any

from .failure import DeviceError, library, no_permission
from .messages import SECOND, MessageDevice, Receiver, Use, decoded, encoded, shortened

_LINE = re.compile(rb"([A-Za-z_]\w*(?:\[\d+\])?) +(.+)")
_LONGEST = 4096
"""Bytes of a line; more without an end of line is nonsense."""


class Serial(MessageDevice):
    """The serial line ``path`` (``/dev/ttyUSB0``, ``COM3``), with lines of text: ``NAME VALUE``, the value as in JSON.

    Lines from the board that begin with ``#`` are for people. The first one may be cut, so it is not looked at.
    """

    def __init__(
        self,
        outputs: Mapping[str, Use],
        inputs: Sequence[str],
        *,
        path: str,
        baud: int = 115200,
        patience: int = 10 * SECOND,
        timeout: int = 0,
    ) -> None:
        super().__init__(f"serial {path}", outputs, patience=patience, timeout=timeout)
        self._path = path
        self._baud = baud
        self._begun = b""
        self._is_first = True
        self._line: Any = None
        self._receiver: Receiver | None = None

    def connect(self) -> None:
        """See ``MessageDevice.connect``."""
        serial = library("serial", "pyserial", "serial")
        try:
            self._line = serial.Serial(self._path, self._baud, timeout=0.1, write_timeout=1, exclusive=True)
        except serial.SerialException as error:
            raise self._explained(error) from None
        self._receiver = Receiver(self, self._receive)

    def _explained(self, error: Any) -> DeviceError:
        if error.errno == errno.EACCES:
            return no_permission(self._path, "dialout")
        if error.errno == errno.ENOENT:
            others = ", ".join(port.device for port in _ports())
            return DeviceError(f"it is not there: plug it in{f' (there are {others})' if others else ''}")
        if error.errno in (errno.EBUSY, errno.EAGAIN):
            return DeviceError("another program uses it: close that first")
        return DeviceError(str(error))

    def disconnect(self) -> None:
        """See ``MessageDevice.disconnect``."""
        if self._receiver is not None:
            self._receiver.stop()
        if self._line is not None:
            self._line.close()

    def _receive(self) -> None:
        try:
            data = self._line.read(max(self._line.in_waiting, 1))
        except OSError:
            raise DeviceError("it was unplugged, or the board is off") from None
        *lines, self._begun = (self._begun + data).split(b"\n")
        for line in lines:
            if self._is_first:
                self._is_first = False
            else:
                self._take(line.strip())
        if len(self._begun) > _LONGEST:
            raise self._nonsense(self._begun)

    def _take(self, line: bytes) -> None:
        if not line or line.startswith(b"#"):
            return
        parts = _LINE.fullmatch(line)
        if parts is None:
            raise self._nonsense(line)
        self.receive(parts[1].decode(), decoded(parts[2]))

    def _nonsense(self, data: bytes) -> DeviceError:
        account = f"received {shortened(data)}, which is no line `NAME VALUE`"
        return DeviceError(f"{account}: does the board have {self._baud} baud?")

    def send(self, port: str, value: Any) -> None:
        """See ``MessageDevice.send``."""
        try:
            self._line.write(f"{port} {encoded(value)}\n".encode())
        except OSError as error:
            raise DeviceError(f"it does not take what is written: {error}") from None


def found() -> list[str]:
    """The serial lines of this machine."""
    return [f"{port.device}: {port.description}" for port in _ports()]


def _ports() -> list[Any]:
    return sorted(library("serial.tools.list_ports", "pyserial", "serial").comports())
