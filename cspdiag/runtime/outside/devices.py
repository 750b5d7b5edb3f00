"""The drivers of a run: opened, released and closed.

Invariants: an output whose driver was opened is handed its safe value once, as its last value; a driver that was opened
is closed once, after that. A driver that fails or hangs does not prevent either for another one.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Sequence
from typing import Any

from ..kernel.child import end_of_child
from ..kernel.clock import Clock
from ..kernel.exceptions import DriverError
from ..kernel.stopping import stopping
from .drivers import DriverFailed, Signal, device_of, name_of
from .event_inputs import EventInput
from .external import EventOutput, Port, SampledOutput
from .lines import DirectLine, EventLine, OutputLine, SampleLine, ThreadLine
from .release import Release
from .sampled_inputs import SampledInput
from .watch import PATIENCE, Call, Watch


class Devices:
    """All drivers of a network during one run.

    ``driven``: whether there are any, besides the signals of a simulated environment.
    """

    def __init__(self, ports: Sequence[Port], clock: Clock) -> None:
        self._all = tuple(ports)
        self._ports = [port for port in ports if port.driver is not None and type(port.driver) is not Signal]
        self.driven = bool(self._ports)
        self._clock = clock
        self._threads: list[ThreadLine] = []
        self._opened: list[tuple[Any, str]] = []
        self._brought: deque[tuple[EventInput[Any], Any] | DriverError] = deque()
        self.watch = Watch(look=self._look, stuck=self._release_elsewhere)
        self._lock = threading.Lock()
        self._releasing: Release | None = None
        for port in ports:
            port.line = port.driver
            if isinstance(port, EventInput):
                port.polled = port.driver is not None
        for port in self._ports:
            blocking = clock.real and getattr(port.driver, "blocking", False)
            port.line = self._thread_of(port) if blocking else DirectLine(port, self.watch, self._limit)

    @property
    def _limit(self) -> float | None:
        """Unlimited in virtual time, where only the user waits for a driver."""
        return PATIENCE if self._clock.real else None

    def _thread_of(self, port: Port) -> ThreadLine:
        line: ThreadLine
        match port:
            case SampledInput():
                line = SampleLine(port, self.bring)
            case EventInput():
                line = EventLine(port, self.bring)
                port.polled = False
            case SampledOutput() | EventOutput():
                line = OutputLine(port, self.bring)
        self._threads.append(line)
        return line

    def open(self) -> None:
        """Opens every device once, and starts the threads. Raises DriverFailed, and Stopped if a signal has arrived."""
        if self.driven or stopping.is_entered:
            self.watch.begin()
        seen: set[int] = set()
        for port in self._ports:
            device = device_of(port.driver)
            if id(device) in seen:
                continue
            seen.add(id(device))
            if not self._clock.real and getattr(device, "needs_real_time", False):
                reason = ValueError("it needs real time; on the command line: --real-time")
                raise DriverFailed(DriverError(name_of(device), port.name, "open", reason))
            opening = getattr(device, "open", None)
            if opening is not None:
                self.watch.call(Call(name_of(device), port.name, "open", None), opening)
            self._opened.append((device, port.name))
            stopping.check()
        if self.driven:
            stopping.install()  # A driver may have installed handlers of its own.
        for line in self._threads:
            line.thread.start()

    def bring(self, what: tuple[Any, Any] | DriverError) -> None:
        """Hands something from a driver's thread over to the scheduler's."""
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

    def _look(self) -> None:
        for line in self._threads:
            line.look()

    def release(self) -> tuple[list[tuple[str, Any]], Sequence[BaseException]]:
        """Hands over the safe values and closes the devices that were opened. Returns what was released, and the
        errors.
        """
        release = self._release()
        release.run()
        self._cut_off()
        return release.released, release.errors

    def _release(self) -> Release:
        with self._lock:
            if self._releasing is None:
                self._releasing = Release(self._all, self._opened, self._threads, self.watch)
            return self._releasing

    def _cut_off(self) -> None:
        """Nothing more is handed over."""
        for port in self._ports:
            port.line = None

    def leave(self) -> None:
        """Called in a forked child: the devices belong to its parent."""
        for port in self._ports:
            port.line = end_of_child

    def _release_elsewhere(self, hanging: Exception) -> None:
        """Releases the outputs from another thread, as the scheduler's hangs in a driver or a process."""
        release = self._release()
        self._cut_off()
        release.run_elsewhere()
        stopping.end_by_force(hanging, release.errors)
