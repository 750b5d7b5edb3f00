"""CAN: the signals of a DBC file, with python-can and cantools."""

from __future__ import annotations

import errno
from collections.abc import Mapping, Sequence
from typing import Any

from .failure import DeviceError, library
from .messages import SECOND, MessageDevice, Receiver, Use, addressed


class Can(MessageDevice):
    """Signals of the messages that the file ``dbc`` describes, in its units.

    The signal of a port is its ``PORT_signal``, ``Signal`` or ``Message.Signal``, by default the name of the port. A
    write sends the message of the signal, with the latest values of its other signals. ``interface`` and ``channel``
    are those of python-can.
    """

    def __init__(
        self,
        outputs: Mapping[str, Use],
        inputs: Sequence[str],
        *,
        dbc: str,
        interface: str = "socketcan",
        bus: str = "can0",
        bitrate: int = 500000,
        patience: int = 10 * SECOND,
        timeout: int = 0,
        **signals: str,
    ) -> None:
        super().__init__(f"can {bus}", outputs, patience=patience, timeout=timeout)
        self._dbc = dbc
        self._interface, self._channel, self._bitrate = interface, bus, bitrate
        self._outputs = addressed(outputs, "signal", signals)
        self._inputs = addressed(inputs, "signal", signals)
        self._received: dict[int, tuple[Any, dict[str, str]]] = {}
        self._sent: dict[str, tuple[Any, str, dict[str, Any]]] = {}
        self._can: Any = None
        self._bus: Any = None
        self._receiver: Receiver | None = None

    def connect(self) -> None:
        """See ``MessageDevice.connect``."""
        self._can = library("can", "python-can", "can")
        self._resolve(self._loaded())
        try:
            self._bus = self._can.Bus(interface=self._interface, channel=self._channel, bitrate=self._bitrate)
        except (OSError, self._can.CanError) as error:
            raise self._explained(error) from None
        self._receiver = Receiver(self, self._receive)

    def _loaded(self) -> Any:
        cantools = library("cantools", "cantools", "can")
        try:
            return cantools.database.load_file(self._dbc)
        except OSError as error:
            raise DeviceError(f"{self._dbc}: {error.strerror}; paths are relative to where the run starts") from None
        # ValueError for a name with another ending.
        except (cantools.database.UnsupportedDatabaseFormatError, cantools.database.errors.Error, ValueError) as error:
            raise DeviceError(f"{self._dbc} is not a file that cantools reads: {error}") from None

    def _resolve(self, database: Any) -> None:
        """Finds the message of each port."""
        for port, name in self._outputs.items():
            message, signal = self._found(database, name)
            self._received.setdefault(message.frame_id, (message, {}))[1][signal] = port
        values: dict[str, dict[str, Any]] = {}
        for port, name in self._inputs.items():
            message, signal = self._found(database, name)
            initial = {other.name: other.initial or 0 for other in message.signals}
            self._sent[port] = message, signal, values.setdefault(message.name, initial)

    def _found(self, database: Any, name: str) -> tuple[Any, str]:
        of_message, _, signal = name.rpartition(".")
        found = [
            message
            for message in database.messages
            if of_message in ("", message.name) and any(each.name == signal for each in message.signals)
        ]
        if len(found) == 1:
            return found[0], signal
        if found:
            choices = ", ".join(f"{message.name}.{signal}" for message in found)
            raise DeviceError(f"several messages have the signal {signal}: choose one of {choices}")
        known = sorted({each.name for message in database.messages for each in message.signals})
        listed = ", ".join(known[:10]) + (", ..." if len(known) > 10 else "")
        raise DeviceError(f"{self._dbc} has no signal {name}; it has {listed}")

    def _explained(self, error: Exception) -> DeviceError:
        code = getattr(error, "errno", None) or getattr(error, "error_code", None)
        up = f"sudo ip link set {self._channel} up type can bitrate {self._bitrate}"
        if code == errno.ENODEV:
            return DeviceError(f"there is no {self._channel}: plug the adapter in, then {up}")
        if code == errno.ENETDOWN:
            return DeviceError(f"{self._channel} is down: {up}")
        if code == errno.EAFNOSUPPORT:
            return DeviceError("this system has no CAN (SocketCAN of Linux): choose another `interface` of python-can")
        return DeviceError(f"{error}")

    def disconnect(self) -> None:
        """See ``MessageDevice.disconnect``."""
        if self._receiver is not None:
            self._receiver.stop()
        if self._bus is not None:
            self._bus.shutdown()

    def _receive(self) -> None:
        try:
            frame = self._bus.recv(0.1)
        except (OSError, self._can.CanError) as error:
            raise self._explained(error) from None
        # A remote frame is a question, to which the node that has the message answers.
        if frame is None or frame.is_error_frame or frame.is_remote_frame:
            return
        if frame.arbitration_id not in self._received:
            return
        message, ports = self._received[frame.arbitration_id]
        try:
            values = message.decode(frame.data, decode_choices=False)
        except Exception as error:
            raise DeviceError(f"received {frame.data.hex()}, which is no message {message.name}: {error}") from None
        for signal, port in ports.items():
            if signal in values:
                self.receive(port, values[signal])

    def send(self, port: str, value: Any) -> None:
        """See ``MessageDevice.send``."""
        message, signal, values = self._sent[port]
        values[signal] = value
        try:
            data = message.encode(values)
        except Exception as error:
            raise DeviceError(f"{value!r} does not fit the signal {signal}: {error}") from None
        frame = self._can.Message(
            arbitration_id=message.frame_id, is_extended_id=message.is_extended_frame, is_fd=message.is_fd, data=data
        )
        try:
            self._bus.send(frame, timeout=0.1)
        except (OSError, self._can.CanError) as error:
            account = f"the message {message.name} is not taken ({error})"
            raise DeviceError(f"{account}: check the wiring, its two resistors of 120 ohms, and the bit rate") from None


def found() -> list[str]:
    """The buses of Linux; for other adapters, see the documentation of python-can."""
    can = library("can", "python-can", "can")
    return [f'bus "{each["channel"]}"' for each in can.detect_available_configs("socketcan")]
