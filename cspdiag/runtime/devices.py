"""The drivers of a run: opened, spoken to, released and closed.

Every port speaks to its driver through a *line*. That is the driver itself, unless its calls block and the run is in real time: then a thread makes the
calls, and what it brings is taken over by the scheduler's thread between two steps of processes.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Sequence
from typing import Any

from .clock import Clock
from .drivers import NO_SAMPLE, DriverFailed, name_of
from .exceptions import DriverError
from .external import EventOutput, Port, SampledOutput
from .inputs import EventInput, SampledInput

_PATIENCE = 2.0
"""Seconds that a blocking driver has to take a safe value and to end."""


class _Line:
    """A thread that makes the blocking calls of one port."""

    def __init__(self, port: Port, devices: Devices) -> None:
        self.port = port
        self.driver: Any = port.driver
        self.devices = devices
        self.closing = False
        self.thread = threading.Thread(target=self._run, name=f"driver of {port.name}", daemon=True)

    def _run(self) -> None:
        try:
            self.work()
        except Exception as error:
            if not self.closing:
                operation = "read" if isinstance(self.port, SampledInput | EventInput) else "write"
                self.devices.bring(DriverError(name_of(self.driver), self.port.name, operation, error))

    def work(self) -> None:
        """What the thread does."""
        raise NotImplementedError

    def close(self) -> None:
        """Lets the thread end."""
        self.closing = True


class _EventLine(_Line):
    """Every value that a blocking ``read`` returns is an event."""

    def work(self) -> None:
        while not self.closing:
            self.devices.bring((self.port, self.driver.read()))

    def read(self) -> Any:
        raise AssertionError("events are brought, not polled")


class _SampleLine(_Line):
    """Reads once a period, ahead: a tick takes what was read since the tick before."""

    def __init__(self, port: Port, devices: Devices) -> None:
        super().__init__(port, devices)
        self._wanted = threading.Semaphore(1)
        self._busy = True
        self._value: Any = NO_SAMPLE

    def work(self) -> None:
        while True:
            self._wanted.acquire()
            if self.closing:
                return
            self._value = self.driver.read()
            self._busy = False

    def read(self) -> Any:
        if self._busy:
            return NO_SAMPLE
        self._busy = True
        self._wanted.release()
        return self._value

    def close(self) -> None:
        super().close()
        self._wanted.release()


class _OutputLine(_Line):
    """Writes the latest value; one that was not yet written when the next came is dropped."""

    def __init__(self, port: Port, devices: Devices) -> None:
        super().__init__(port, devices)
        self._changed = threading.Condition()
        self._values: deque[Any] = deque(maxlen=1)

    def work(self) -> None:
        while True:
            with self._changed:
                while not self._values and not self.closing:
                    self._changed.wait()
                if not self._values:
                    return
                value = self._values.popleft()
            self.driver.write(value)

    def write(self, value: Any) -> None:
        with self._changed:
            self._values.append(value)
            self._changed.notify()

    def close(self) -> None:
        with self._changed:
            self.closing = True
            self._changed.notify()


class Devices:
    """All drivers of a network during one run."""

    def __init__(self, ports: Sequence[Port], clock: Clock) -> None:
        self._ports = [port for port in ports if port.driver is not None]
        self._clock = clock
        self._lines: list[_Line] = []
        self._opened: list[tuple[Any, str]] = []
        self._brought: deque[tuple[EventInput[Any], Any] | DriverError] = deque()
        for port in ports:
            port.line = port.driver
            if isinstance(port, EventInput):
                port.polled = port.driver is not None
            if clock.real and getattr(port.driver, "blocking", False):
                self._lines.append(self._line_of(port))

    def _line_of(self, port: Port) -> _Line:
        line: _Line
        match port:
            case SampledInput():
                line = _SampleLine(port, self)
            case EventInput():
                line = _EventLine(port, self)
                port.polled = False
            case SampledOutput() | EventOutput():
                line = _OutputLine(port, self)
        port.line = line
        return line

    def open(self) -> None:
        """Opens every device once, and starts the threads. Raises DriverFailed."""
        seen: set[int] = set()
        for port in self._ports:
            device = getattr(port.driver, "device", port.driver)
            if id(device) in seen:
                continue
            seen.add(id(device))
            try:
                opening = getattr(device, "open", None)
                if opening is not None:
                    opening()
            except Exception as error:
                raise DriverFailed(DriverError(name_of(device), port.name, "open", error)) from error
            self._opened.append((device, port.name))
        for line in self._lines:
            line.thread.start()

    def bring(self, what: tuple[Any, Any] | DriverError) -> None:
        """Something from a driver's thread, for the scheduler's."""
        self._brought.append(what)
        self._clock.notify()

    @property
    def has_news(self) -> bool:
        """Whether something was brought."""
        return bool(self._brought)

    def take_over(self) -> None:
        """Offers the events that were brought. Raises DriverFailed."""
        while self._brought:
            brought = self._brought.popleft()
            if isinstance(brought, DriverError):
                raise DriverFailed(brought)
            port, value = brought
            port.occur(value)

    def release(self) -> tuple[list[tuple[str, Any]], list[BaseException]]:
        """Hands over the safe values and closes the devices that were opened: what was released, and what failed."""
        released: list[tuple[str, Any]] = []
        errors: list[BaseException] = []
        opened = {id(device) for device, _ in self._opened}
        for port in self._ports:
            if not isinstance(port, SampledOutput | EventOutput) or port.safe is None:
                continue
            if id(getattr(port.driver, "device", port.driver)) in opened:
                try:
                    port.line.write(port.safe)
                    released.append((port.name, port.safe))
                except BaseException as error:
                    errors.append(DriverError(name_of(port.driver), port.name, "write", error))
        self._end_lines((_OutputLine,))
        for line in self._lines:
            line.closing = True
        for device, port_name in self._opened:
            try:
                closing = getattr(device, "close", None)
                if closing is not None:
                    closing()
            except BaseException as error:
                errors.append(DriverError(name_of(device), port_name, "close", error))
        self._end_lines((_SampleLine, _EventLine))
        return released, errors

    def _end_lines(self, kinds: tuple[type[_Line], ...]) -> None:
        lines = [line for line in self._lines if isinstance(line, kinds) and line.thread.is_alive()]
        for line in lines:
            line.close()
        for line in lines:
            line.thread.join(_PATIENCE if isinstance(line, _OutputLine) else 0.05)
