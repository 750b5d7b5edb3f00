"""What devices there are, and what each offers. The compiler reads this, and nothing else of them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, TypeAlias

from cspdiag.base.record import record

TypeName: TypeAlias = Literal["bool", "double", "int", "text", "time"]
ValueName: TypeAlias = Literal["bool", "double", "int", "array"]


@record
class OfferedPort:
    """A port; ``count`` is how many there are whose names end with a number, from 0."""

    name: str
    type: TypeName
    doc: str
    count: int = 0

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the ports."""
        return tuple(f"{self.name}{at}" for at in range(self.count)) if self.count else (self.name,)


@record
class OfferedParameter:
    """A parameter; without a ``default``, as the language writes it, a driver has to declare it."""

    name: str
    type: TypeName
    doc: str
    default: str | None = None


@record
class Device:
    """A device, and what it offers: its class is in the module of its name.

    ``requirements`` are what its extra of cspdiag installs. ``outputs`` are the ports that it has; None: those that the
    driver declares, in both directions, of the types ``values`` (arrays: of the others). Then a parameter
    ``PORT_SUFFIX`` of a driver says what a port is: ``address`` is that suffix, its type and what it means; without a
    default it has to be declared.
    """

    name: str
    summary: str
    requirements: tuple[str, ...]
    parameters: tuple[OfferedParameter, ...]
    outputs: tuple[OfferedPort, ...] | None
    values: tuple[ValueName, ...]
    address: OfferedParameter | None

    @property
    def class_(self) -> str:
        """The class in its module."""
        return self.name.capitalize()

    @property
    def extra(self) -> str:
        """The extra of cspdiag that installs what it needs; empty if it needs nothing."""
        return self.name if self.requirements else ""

    @property
    def module(self) -> str:
        """The module in ``cspdiag.devices``."""
        return self.name

    def output(self, name: str) -> OfferedPort | None:
        """The port of this name, if the device has a fixed set of ports."""
        return next((port for port in self.outputs or () if name in port.names), None)


_Parameter: TypeAlias = "tuple[str, TypeName, str] | tuple[str, TypeName, str, str]"
_Port: TypeAlias = "tuple[str, TypeName, str] | tuple[str, TypeName, str, int]"
"""As ``OfferedParameter`` and ``OfferedPort``."""

_WAITS: tuple[_Parameter, ...] = (
    ("patience", "time", "how long the first value of each sampled port may take", "10 s"),
    ("timeout", "time", "how long a sampled port may be silent after that; 0 s: without limit", "0 s"),
)
"""Of what sends values by itself."""


def _device(
    name: str,
    summary: str,
    *parameters: _Parameter,
    needs: tuple[str, ...] = (),
    outputs: tuple[_Port, ...] | None = None,
    values: tuple[ValueName, ...] = ("bool", "int", "double", "array"),
    address: _Parameter | None = None,
) -> Device:
    return Device(
        name,
        summary,
        needs,
        tuple(OfferedParameter(*parameter) for parameter in parameters),
        None if outputs is None else tuple(OfferedPort(*port) for port in outputs),
        values,
        None if address is None else OfferedParameter(*address),
    )


_ALL = (
    _device(
        "can",
        "signals of a CAN bus, as a DBC file describes them",
        ("dbc", "text", "the file that describes the messages (DBC, ARXML, KCD, SYM)"),
        ("interface", "text", "the kind of adapter, as python-can calls it", '"socketcan"'),
        ("bus", "text", "which bus, the channel of python-can", '"can0"'),
        ("bitrate", "int", "bits a second", "500000"),
        *_WAITS,
        needs=("python-can>=4.3", "cantools>=39"),
        values=("bool", "int", "double"),
        address=("signal", "text", "the signal of a port, if it has another name", ""),
    ),
    _device(
        "gamepad",
        "gamepads and joysticks",
        ("index", "int", "which one of those that are plugged in", "0"),
        ("dead_zone", "double", "below this an axis is at rest", "0.05"),
        needs=("pygame-ce>=2.5",),
        outputs=(
            ("x", "double", "first stick, -1 (left) to 1 (right); the same as axis0"),
            ("y", "double", "first stick, -1 (up) to 1 (down); the same as axis1"),
            ("axis", "double", "any axis, -1 to 1", 8),
            ("hat_x", "int", "directional pad: -1, 0 or 1 (right)"),
            ("hat_y", "int", "directional pad: -1, 0 or 1 (up)"),
            ("button", "bool", "whether the first button is pressed; the same as button0"),
            ("button", "bool", "whether a button is pressed", 16),
            ("buttons", "int", "all buttons: 1 for the first, 2 for the second, 4 for the third, added up"),
        ),
    ),
    _device(
        "gpio",
        "lines of a GPIO chip of Linux",
        ("chip", "text", "the chip", '"/dev/gpiochip0"'),
        ("bias", "text", "of inputs: as_is, pull_up, pull_down or disabled", '"as_is"'),
        ("active_low", "bool", "whether a low voltage is true", "false"),
        needs=("gpiod>=2.1; sys_platform == 'linux'",),
        values=("bool",),
        address=("line", "int", "the number of the line at its chip"),
    ),
    _device(
        "keyboard",
        "the keys of the terminal in which the program runs",
        ("path", "text", "the terminal", '"/dev/tty"'),
        ("hold", "time", "how long a key counts as pressed after its last report", "200 ms"),
        ("step", "double", "how far an arrow key moves x or y", "0.1"),
        outputs=(
            ("x", "double", "moved by the arrows left and right, -1 to 1; Home and 0 return it"),
            ("y", "double", "moved by the arrows up and down, -1 (up) to 1"),
            ("buttons", "int", "the keys 1 to 9, added up: 1 for the first, 2 for the second, 4 for the third"),
            ("space", "bool", "whether the space bar is pressed"),
            ("enter", "bool", "whether Enter is pressed"),
            ("key", "int", "the code of the key that is pressed, such as 97 for a; 0 for none"),
        ),
    ),
    _device(
        "mqtt",
        "topics of an MQTT broker",
        ("host", "text", "where the broker is", '"localhost"'),
        ("port", "int", "its port; with TLS mostly 8883", "1883"),
        ("prefix", "text", "topics begin with this", '""'),
        ("qos", "int", "quality of service: 0, 1 or 2", "0"),
        ("tls", "bool", "whether the connection is encrypted", "false"),
        ("user", "text", "with the password in the variable MQTT_PASSWORD", '""'),
        *_WAITS,
        needs=("paho-mqtt>=2.0",),
        address=("topic", "text", "the topic of a port, if it is not the prefix and its name", ""),
    ),
    _device(
        "opcua",
        "variables of an OPC UA server",
        ("url", "text", "where the server is", '"opc.tcp://localhost:4840"'),
        ("interval", "time", "how often the server reports changes", "10 ms"),
        ("user", "text", "with the password in the variable OPCUA_PASSWORD", '""'),
        *_WAITS,
        needs=("asyncua>=1.1",),
        address=("node", "text", "the variable of a port, such as ns=2;s=Level"),
    ),
    _device(
        "serial",
        "boards behind a serial line or USB, with lines of text",
        ("path", "text", "such as /dev/ttyUSB0 or COM3"),
        ("baud", "int", "the speed in bits a second", "115200"),
        *_WAITS,
        needs=("pyserial>=3.5",),
    ),
    _device(
        "udp",
        "datagrams of JSON or of C structures",
        ("port", "int", "the port to listen at; 0: any", "0"),
        ("bind", "text", "the interface to listen at; 0.0.0.0: all", '"127.0.0.1"'),
        ("to", "text", "HOST:PORT to send to; empty: to the last sender", '""'),
        ("out_format", "text", "the `out` ports as a C structure, such as <hf; empty: JSON", '""'),
        ("in_format", "text", "the `in` ports as a C structure; empty: JSON", '""'),
        *_WAITS,
    ),
    _device(
        "zenoh",
        "keys of a Zenoh network",
        ("connect", "text", "an endpoint to connect to, such as tcp/192.168.1.7:7447", '""'),
        ("listen", "text", "an endpoint to listen at, such as tcp/0.0.0.0:7447", '""'),
        ("multicast", "bool", "whether peers of the local network are found", "true"),
        ("prefix", "text", "keys begin with this", '""'),
        *_WAITS,
        needs=("eclipse-zenoh>=1.0",),
        address=("key", "text", "the key of a port, if it is not the prefix and its name", ""),
    ),
)

DEVICES = {device.name: device for device in _ALL}
"""The devices by name."""


def port_names(device: Device) -> tuple[str, ...]:
    """The names of the ports of a device with a fixed set of ports."""
    return tuple(name for port in device.outputs or () for name in port.names)


def parameter_names(device: Device, ports: Iterable[str]) -> tuple[str, ...]:
    """The parameters that a driver with these ports may declare."""
    suffix = () if device.address is None else (f"{port}_{device.address.name}" for port in ports)
    return (*(parameter.name for parameter in device.parameters), *suffix)


def parameter(device: Device, name: str, ports: Iterable[str]) -> OfferedParameter | None:
    """What the parameter of this name is in a driver with these ports."""
    for offered in device.parameters:
        if offered.name == name:
            return offered
    address = device.address
    return address if address is not None and any(name == f"{port}_{address.name}" for port in ports) else None
