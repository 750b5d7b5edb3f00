"""The release of the outputs at the end of a run, whatever ended it."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

from ..kernel.exceptions import RunFailed
from ..kernel.stopping import stopping
from .drivers import Signal, device_of, name_of
from .external import EventOutput, Port, SampledOutput
from .lines import OutputLine, ThreadLine
from .watch import PATIENCE, PATIENCE_AT_CLOSE, Call, Watch

Output: TypeAlias = "SampledOutput[Any] | EventOutput[Any]"

_Job: TypeAlias = "tuple[Call | None, Callable[[], None]]"
"""The driver's call that a job consists of, if any, and the job."""


class Release:
    """Hands each output that was opened its safe value, as its last value, and closes each device after that.

    A driver that fails or hangs does not prevent either for another one. The jobs are a queue: another thread can
    continue with it if the scheduler's thread hangs in a driver.
    """

    def __init__(
        self, ports: Sequence[Port], opened: Sequence[tuple[Any, str]], threads: Sequence[ThreadLine], watch: Watch
    ) -> None:
        self.released: list[tuple[str, Any]] = []
        self.errors: list[Exception] = []
        self._threads = threads
        self._watch = watch
        watch.releasing = True
        self._until = time.monotonic() + PATIENCE
        self._elsewhere: threading.Thread | None = None
        self._jobs: deque[_Job] = deque()
        devices = {id(device) for device, _ in opened}
        outputs = [
            port
            for port in ports
            if isinstance(port, SampledOutput | EventOutput)
            and port.safe is not None
            and (isinstance(port.driver, Signal) or id(device_of(port.driver)) in devices)
        ]
        served = [port for port in outputs if _has_thread(port)]
        self._jobs += [(None, self._beginning(port.line, port.safe)) for port in served]
        self._jobs += [self._write(port) for port in outputs if port not in served]
        self._jobs += [(None, self._finishing(port, port.line)) for port in served]
        self._jobs.append((None, self._end_reading))
        self._jobs += [self._close(device, port) for device, port in opened]

    def run(self) -> None:
        """Does all jobs; what fails is added to ``errors``."""
        while self._jobs:
            call, job = self._jobs.popleft()
            try:
                self._do(call, job)
            except RunFailed as failed:
                self._note(failed.error)
        if self._elsewhere is not None:
            self._elsewhere.join()
        for line in self._threads:
            line.close()
        for line in self._threads:
            if line.thread.is_alive():
                line.thread.join(0.05)

    def _do(self, call: Call | None, job: Callable[[], None]) -> None:
        """Does one job, and does it again if it is cut off by a Ctrl-C that a driver leaves to Python. What a driver
        itself raises is a failure like any other.
        """
        try:
            self._attempt(call, job)
        except KeyboardInterrupt:
            try:
                self._attempt(call, job)
            except KeyboardInterrupt as error:
                if call is not None:
                    raise call.failed(error) from error

    def _attempt(self, call: Call | None, job: Callable[[], None]) -> None:
        if call is None:
            job()
        else:
            self._watch.call(call, job)

    def run_elsewhere(self) -> None:
        """Continues from this thread if the scheduler's thread hangs."""
        self._elsewhere = threading.current_thread()
        while self._jobs:
            call, job = self._jobs.popleft()
            self._bounded(call, job)

    def _bounded(self, call: Call | None, job: Callable[[], None]) -> None:
        def work() -> None:
            try:
                job()
            except RunFailed as failed:
                self._note(failed.error)
            except BaseException as error:
                assert call is not None
                self._note(call.failed(error).error)
            finally:
                stopping.end_child()

        thread = threading.Thread(target=work, daemon=True)
        thread.start()
        thread.join(2 * PATIENCE if call is None else call.limit)
        if thread.is_alive() and call is not None:
            self._note(call.hangs().error)

    def _note(self, error: Exception) -> None:
        """Adds an error, once: the call that replaces one that hangs may hang as well."""
        if str(error) not in map(str, self.errors):
            self.errors.append(error)

    def _write(self, port: Output) -> _Job:
        driver: Any = port.driver

        def write() -> None:
            driver.write(port.safe)
            self.released.append((port.name, port.safe))

        return Call(name_of(port.driver), port.name, "write", PATIENCE), write

    def _beginning(self, line: OutputLine, safe: Any) -> Callable[[], None]:
        return lambda: line.begin_release(safe)

    def _finishing(self, port: Output, line: OutputLine) -> Callable[[], None]:
        def finish() -> None:
            try:
                line.finish_release(self._until)
            except RunFailed as failed:
                self._note(failed.error)
                if line.is_writing_another_value:
                    self._bounded(*self._write(port))
            else:
                self.released.append((port.name, port.safe))

        return finish

    def _end_reading(self) -> None:
        for line in self._threads:
            line.closing = True

    def _close(self, device: Any, port: str) -> _Job:
        return Call(name_of(device), port, "close", PATIENCE_AT_CLOSE), getattr(device, "close", _nothing)


def _has_thread(port: Output) -> bool:
    """Whether its calls are made by a thread, which may not have begun."""
    return isinstance(port.line, OutputLine) and port.line.thread.is_alive()


def _nothing() -> None:
    pass
