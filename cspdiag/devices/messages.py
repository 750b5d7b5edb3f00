"""What devices have in common that exchange messages: a receiver thread brings values, ports give or wait for them."""

from __future__ import annotations

import json
import re
import threading
import time
from collections.abc import Callable, Iterable, Mapping
from enum import Enum
from queue import SimpleQueue
from typing import Any, Literal, TypeAlias

from .failure import DeviceError

Use: TypeAlias = Literal["sampled", "event", "unused"]
"""What the program does with an output of a device: it samples the latest value, or each message is an event."""

MILLISECOND = 1_000_000
SECOND = 1000 * MILLISECOND

_CLOSED: Any = object()
_MOST_OTHERS = 8
"""Names without a port that are remembered, however many come."""
_NOT_FINITE = re.compile(r'(?<!["\w])(?:(nan)|(inf)(?:inity)?)(?!["\w])', re.IGNORECASE)
"""A NaN or an infinity as ``printf`` and ``Serial.print`` write it."""


class MessageDevice:
    """A device whose outputs are messages by port.

    A subclass has ``connect``, ``disconnect`` and ``send``; a thread of its own calls ``receive`` and ``fail``.
    Durations are in nanoseconds: ``patience`` is for the first value of every sampled output, and afterwards each of
    them may be silent for ``timeout`` (0: without limit).
    """

    needs_real_time = True

    def __init__(self, name: str, outputs: Mapping[str, Use], *, patience: int = 10 * SECOND, timeout: int = 0) -> None:
        self.name = name
        self.blocking = frozenset(port for port, use in outputs.items() if use == "event")
        self._sampled = frozenset(port for port, use in outputs.items() if use == "sampled")
        self._events: dict[str, SimpleQueue[Any]] = {port: SimpleQueue() for port in self.blocking}
        self._latest: dict[str, Any] = {}
        self._since: dict[str, float] = {}
        self._others: dict[str, None] = {}
        self._failure: Exception | None = None
        self._changed = threading.Condition()
        self._wait, self._timeout = patience / SECOND, timeout / SECOND

    def connect(self) -> None:
        """Begin to receive. Raises DeviceError, and what the library raises."""
        raise NotImplementedError

    def disconnect(self) -> None:
        """Stop receiving; also called if ``connect`` has failed."""
        raise NotImplementedError

    def send(self, port: str, value: Any) -> None:
        """Hand a plain value (see ``plain``) to the outside."""
        raise NotImplementedError

    def open(self) -> None:
        """Connect, and wait for the first value of every sampled output."""
        try:
            self.connect()
            self._await_first()
        except BaseException:
            self.disconnect()
            raise

    def _await_first(self) -> None:
        with self._changed:
            complete = self._changed.wait_for(
                lambda: self._failure is not None or self._sampled <= self._latest.keys(), self._wait
            )
        self._raise_failure()
        if not complete:
            missing = ", ".join(sorted(self._sampled - self._latest.keys()))
            raise DeviceError(f"no value of {missing} has come within {self._wait:g} s{self._without_port()}")

    def _without_port(self) -> str:
        """The names of values that have come and have no port, for messages."""
        return f"; without a port there were {', '.join(self._others)}" if self._others else ""

    def close(self) -> None:
        """Disconnect, and release the threads that wait for an event."""
        self.disconnect()
        for queue in self._events.values():
            queue.put(_CLOSED)

    def read(self, port: str) -> Any:
        """The latest value of a sampled output; the next event of another one, for which it waits."""
        queue = self._events.get(port)
        if queue is not None:
            value = queue.get()
            if value is not _CLOSED:
                return value
            self._raise_failure()
            raise DeviceError("it is closed")
        self._raise_failure()
        silent = time.monotonic() - self._since[port]
        if 0 < self._timeout < silent:
            account = f"no value of {port} has come for {silent:.3g} s{self._without_port()}"
            raise DeviceError(f"{account}: is the sender still there?")
        return self._latest[port]

    def write(self, port: str, value: Any) -> None:
        """Send a value."""
        self.send(port, plain(value))
        self._raise_failure()

    def receive(self, port: str, value: Any) -> None:
        """Called by the receiver: a value of a port, or of something that is none."""
        queue = self._events.get(port)
        if queue is not None:
            queue.put(value)
        elif port in self._sampled:
            self._since[port] = time.monotonic()
            if port in self._latest:
                self._latest[port] = value
                return
            with self._changed:
                self._latest[port] = value
                self._changed.notify_all()
        else:
            if len(self._others) < _MOST_OTHERS:
                self._others[port] = None

    def fail(self, error: Exception) -> None:
        """Called by the receiver: nothing more will come. The next read or write raises the error."""
        with self._changed:
            self._failure = error
            self._changed.notify_all()
        for queue in self._events.values():
            queue.put(_CLOSED)

    def _raise_failure(self) -> None:
        """Raises what ``fail`` was given, once: outputs are released after that."""
        failure, self._failure = self._failure, None
        if failure is not None:
            raise failure


class Receiver:
    """A thread that repeats a step until it is stopped or the step raises, which fails the device."""

    def __init__(self, device: MessageDevice, step: Callable[[], None]) -> None:
        self._device = device
        self._step = step
        self._stopped = False
        self._thread = threading.Thread(target=self._run, name=f"receiver of {device.name}", daemon=True)
        self._thread.start()

    def _run(self) -> None:
        try:
            while not self._stopped:
                self._step()
        except Exception as error:
            if not self._stopped:
                self._device.fail(error)

    def stop(self) -> None:
        """End the thread, whose steps are short."""
        self._stopped = True
        self._thread.join(1)


def plain(value: Any) -> Any:
    """A value of the program as JSON has it: the number of a literal of an enum, lists."""
    if isinstance(value, Enum):
        return int(value.value)
    return [plain(part) for part in value] if isinstance(value, tuple) else value


def encoded(value: Any) -> str:
    """A plain value as JSON: numbers in full precision."""
    return json.dumps(value)


def parsed(text: str | bytes) -> Any:
    """A value from JSON, in which a NaN and infinities may also be spelled as C does. Raises ValueError for other text,
    and for what is nested too deeply.
    """
    try:
        try:
            return json.loads(text)
        except ValueError:
            return json.loads(_with_names_of_json(text if isinstance(text, str) else text.decode()))
    except RecursionError:
        raise ValueError("it is nested too deeply") from None


def _with_names_of_json(text: str) -> str:
    named = _NOT_FINITE.sub(lambda found: "NaN" if found[1] else "Infinity", text)
    return named.replace("-NaN", "NaN")


def decoded(text: str | bytes) -> Any:
    """A value from JSON; other text is returned as it is, and refused by the port that it is for."""
    try:
        return parsed(text)
    except ValueError:
        return text if isinstance(text, str) else text.decode("utf-8", "backslashreplace")


def shortened(data: Any) -> str:
    """Something that was received, for a message."""
    text = repr(data)
    return text if len(text) <= 60 else f"{text[:57]}..."


def addressed(ports: Iterable[str], suffix: str, given: Mapping[str, str], prefix: str = "") -> dict[str, str]:
    """The address of each port: the parameter ``PORT_SUFFIX`` if it is given, or the name after the prefix."""
    before = f"{prefix.rstrip('/')}/" if prefix else ""
    return {port: given.get(f"{port}_{suffix}", f"{before}{port}") for port in ports}
