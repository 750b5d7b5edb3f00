"""Lines: how ports speak to their drivers during a run.

The scheduler's thread calls a driver itself, unless its calls block and the run is in real time: then a thread makes
the calls, and what it brings is taken over by the scheduler's thread between two steps of processes.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Any

from ..kernel.exceptions import DriverError
from ..kernel.places import line_by_hand
from ..kernel.stopping import stopping
from ..real_time.preference import shift_priority
from .drivers import NO_SAMPLE, name_of
from .external import EventOutput, Port, SampledOutput
from .watch import PATIENCE, Call, Watch

Bring = Callable[[Any], None]
"""Hands something over to the scheduler's thread: a port and its value, or a DriverError."""


class DirectLine:
    """Calls a driver from the scheduler's thread."""

    def __init__(self, port: Port, watch: Watch, limit: float | None) -> None:
        self.driver: Any = port.driver
        self._port = port
        self._watch = watch
        operation = "write" if isinstance(port, SampledOutput | EventOutput) else "read"
        self._call = Call(name_of(port.driver), port.name, operation, limit)
        self._read = _reading(port)

    def read(self) -> Any:
        """One value. Raises DriverFailed."""
        value = self._watch.call(self._call, self._read)
        stopping.check()
        return value

    def write(self, value: Any) -> None:
        """Hands a value over. Raises DriverFailed."""
        self._watch.call(self._call, self.driver.write, value)
        stopping.check()


def _reading(port: Port) -> Callable[[], Any]:
    """Reads a value of the type of the port from its driver. Raises what the driver raises, or TypeError and the like
    for a value of another type.
    """
    driver: Any = port.driver
    accepts = None if isinstance(port, SampledOutput | EventOutput) else port.accepts
    if accepts is None:
        return lambda: driver.read()
    return lambda: accepts(driver.read())


class ThreadLine:
    """A thread that makes the blocking calls of one port."""

    def __init__(self, port: Port, bring: Bring, operation: str) -> None:
        self.port = port
        self.driver: Any = port.driver
        self.closing = False
        self.bring = bring
        self.what = Call(name_of(port.driver), port.name, operation, PATIENCE)
        self.thread = threading.Thread(target=self._run, name=f"driver of {port.name}", daemon=True)

    def _run(self) -> None:
        shift_priority(-1)
        try:
            self.work()
        except BaseException as error:
            self.fail(error)

    def call(self, function: Callable[..., Any], *given: Any) -> Any:
        """Returns what the driver returns, but not in a child that it has forked."""
        try:
            return function(*given)
        finally:
            stopping.end_child()

    def fail(self, error: BaseException) -> None:
        """A call has failed: ends the run, unless that is over."""
        if not self.closing:
            what = self.what
            self.bring(DriverError(what.driver, what.port, what.operation, error, line_by_hand(error)))

    def work(self) -> None:
        """What the thread does."""
        raise NotImplementedError

    def look(self) -> None:
        """Called regularly by the watch."""

    def close(self) -> None:
        """Lets the thread end."""
        self.closing = True


class EventLine(ThreadLine):
    """Every value that a blocking ``read`` returns is an event."""

    def __init__(self, port: Port, bring: Bring) -> None:
        super().__init__(port, bring, "read")
        self._read = _reading(port)

    def work(self) -> None:
        """See ``ThreadLine.work``."""
        while not self.closing:
            self.bring((self.port, self.call(self._read)))

    def read(self) -> Any:
        """Never called."""
        raise AssertionError("events are brought, not polled")


class SampleLine(ThreadLine):
    """Reads once a period, ahead: a tick takes what was read since the previous tick."""

    def __init__(self, port: Port, bring: Bring) -> None:
        super().__init__(port, bring, "read")
        self._read = _reading(port)
        self._wanted = threading.Semaphore(1)
        self._busy = True
        self._value: Any = NO_SAMPLE

    def work(self) -> None:
        """See ``ThreadLine.work``."""
        while True:
            self._wanted.acquire()
            if self.closing:
                return
            self._value = self.call(self._read)
            self._busy = False

    def read(self) -> Any:
        """What was read since the last time; NO_SAMPLE while the driver has not returned."""
        if self._busy:
            return NO_SAMPLE
        self._busy = True
        self._wanted.release()
        return self._value

    def close(self) -> None:
        """See ``ThreadLine.close``."""
        super().close()
        self._wanted.release()


class OutputLine(ThreadLine):
    """Writes the latest value; one that was not yet written when the next one arrived is dropped.

    A write that fails or hangs ends the run, but not the thread: the safe value is still to be written.
    """

    def __init__(self, port: Port, bring: Bring) -> None:
        super().__init__(port, bring, "write")
        self._changed = threading.Condition()
        self._values: deque[Any] = deque(maxlen=1)
        self._since: float | None = None
        self._is_last = False
        self._released = threading.Event()
        self._failure: BaseException | None = None

    def work(self) -> None:
        """See ``ThreadLine.work``."""
        while True:
            with self._changed:
                while not self._values and not self.closing:
                    self._changed.wait()
                last = self.closing
                if not self._values:
                    return
                value = self._values.popleft()
            self._is_last = last
            self._write(value)
            if last:
                self._released.set()
                return

    def _write(self, value: Any) -> None:
        self._since = time.monotonic()
        try:
            self.call(self.driver.write, value)
        except BaseException as error:
            self._failure = error
            self.fail(error)
        else:
            self._failure = None
        finally:
            self._since = None

    def look(self) -> None:
        """Ends the run if a write hangs."""
        since = self._since
        if since is not None and not self.closing and time.monotonic() - since > PATIENCE:
            self.bring(self.what.hangs().error)

    @property
    def is_writing_another_value(self) -> bool:
        """Whether it is in a call of the driver other than that with the safe value."""
        return self._since is not None and not self._is_last

    def write(self, value: Any) -> None:
        """Leaves a value to the thread."""
        with self._changed:
            self._values.append(value)
            self._changed.notify()

    def begin_release(self, safe: Any) -> None:
        """The last value: the thread writes it as soon as it can, and ends."""
        with self._changed:
            self._values.append(safe)
            self.closing = True
            self._changed.notify()

    def finish_release(self, until: float) -> None:
        """Waits until the last value is written, at most until an instant of the monotonic clock. Raises DriverFailed
        if that has failed or has not happened.
        """
        if not self._released.wait(max(0.0, until - time.monotonic())):
            raise self.what.hangs()
        if self._failure is not None:
            raise self.what.failed(self._failure)

    def close(self) -> None:
        """See ``ThreadLine.close``."""
        with self._changed:
            super().close()
            self._changed.notify()
