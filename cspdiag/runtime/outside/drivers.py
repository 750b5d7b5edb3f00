"""Drivers: what is behind the ports of the outermost process."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any, Generic, Protocol, TypeVar

from ..kernel.exceptions import DriverError, RunFailed

T = TypeVar("T")


class Driver(Protocol):
    """One port's side of a device: ``read`` for an input, ``write`` for an output.

    It may have ``open()`` and ``close()``, called before and after the run, and ``blocking = True`` if its calls may
    wait: in real time they are then made outside the scheduler's thread. A device with several ports may instead name
    those ports. With ``needs_real_time = True`` it refuses virtual time. See ``watch`` for how long a call may take.
    """


class DriverFailed(RunFailed):
    """A driver has failed."""

    def __init__(self, error: DriverError) -> None:
        super().__init__(error)


class _NoSample:
    """What a line returns while the device has no new sample."""


NO_SAMPLE: Any = _NoSample()


class DevicePort:
    """One port of a device with several: calls ``device.read(port)`` and ``device.write(port, value)``."""

    def __init__(self, device: Any, port: str) -> None:
        self.device = device
        self.port = port
        self.name = name_of(device)
        blocking = getattr(device, "blocking", False)
        self.blocking = port in blocking if isinstance(blocking, Collection) else bool(blocking)

    def read(self) -> Any:
        """One value of the port."""
        return self.device.read(self.port)

    def write(self, value: Any) -> None:
        """Hands a value to the port."""
        self.device.write(self.port, value)


class Signal(Generic[T]):
    """A value that an environment and a port share."""

    __slots__ = ("value",)

    def __init__(self, initial: T) -> None:
        self.value = initial

    def read(self) -> T:
        """The present value."""
        return self.value

    def write(self, value: T) -> None:
        """Sets the value."""
        self.value = value


def name_of(driver: object) -> str:
    """The name of a driver for people: its ``name``, or its class."""
    return str(getattr(driver, "name", None) or type(driver).__name__)


def device_of(driver: Any) -> Any:
    """What is opened and closed: the device, if the driver is one port of it, or the driver itself."""
    return getattr(driver, "device", driver)
