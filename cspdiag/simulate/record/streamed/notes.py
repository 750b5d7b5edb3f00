"""Takes what a run in Python has noted of its ports, from time to time, and gives it to a recording."""

from __future__ import annotations

import threading
from array import array
from types import TracebackType
from typing import Any, Self

from cspdiag.runtime.kernel.signals import left_to_the_main_thread
from cspdiag.simulate.record.recorder import Recorder
from cspdiag.simulate.record.streamed.recording import WALL_INTERVAL, Recording

_AT_ONCE = 1 << 15
"""The number of values that make a block: half as many cost nearly as much."""
_SECOND = 10**9


class NotedPorts:
    """Used around a run, whose environment is watched: at its first instant after some time all values of earlier
    instants are known. ``recorder`` notes what recordings have (``port_logs``), or all communications.
    """

    def __init__(self, recorder: Recorder, recording: Recording) -> None:
        self._recorder = recorder
        self._recording = recording
        self._due = 0
        self._hurry = False
        self._communications = self._samples = 0
        self._ended = threading.Event()
        self._clock = threading.Thread(target=self._tell_time, name="recording clock", daemon=True)
        rate = sum(_SECOND / port.period for port in recording.head.ports if port.period)
        self._interval = max(1, int(_SECOND * min(1.0, _AT_ONCE / rate))) if rate > _AT_ONCE else _SECOND

    def __enter__(self) -> Self:
        with left_to_the_main_thread():
            self._clock.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._ended.set()
        self._clock.join()

    def _tell_time(self) -> None:
        """Every now and then, what was noted is to be written at the next instant, however little it is."""
        while not self._ended.wait(WALL_INTERVAL):
            self._hurry, self._due = True, 0

    def watch(self, environment: Any) -> None:
        """Be called when the environment advances to an instant, before anything happens at it."""
        kind = type(environment)
        advance = kind.advance

        def advance_and_take(self: Any, now: int) -> Any:
            advanced = advance(self, now)
            if now >= notes._due:
                notes._take_some(now)
            return advanced

        notes = self
        # The name stays: faults of the environment have it.
        environment.__class__ = type(kind.__name__, (kind,), {"__slots__": (), "advance": advance_and_take})

    def _take_some(self, now: int) -> None:
        self._due = now + self._interval
        logs = self._recorder.port_logs
        if logs is not None and not self._hurry and sum(len(times) for times, _ in logs.values()) < _AT_ONCE:
            return
        self._hurry = False
        self.take(now)

    def take(self, before: int | None) -> None:
        """Give everything that was noted before this instant to the recording; None: the run is over, and the
        last instant is complete when the recording is finished.
        """
        logs = self._recorder.port_logs
        if logs is None:
            self._take_communications()
        else:
            for channel, (times, values) in logs.items():
                count = len(times)
                if count:
                    self._recording.add_noted(channel, times, values)
                    del times[:count], values[:count]
        if before is not None:
            self._recording.pass_time(before)

    def _take_communications(self) -> None:
        """From the logs of all communications and samples, which stay as they are."""
        recorder, recording = self._recorder, self._recording
        found: dict[str, tuple[array[int], list[Any]]] = {}

        def note(time: int, channel: str, value: Any) -> None:
            times, values = found.setdefault(channel, (array("q"), []))
            times.append(time)
            values.append(value)

        sampled = {name for name, at in recording.positions.items() if recording.head.ports[at].is_sampled_input}
        log = recorder.sample_log
        end = len(log)
        for at in range(self._samples, end, 3):
            note(log[at], log[at + 1], log[at + 2])
        self._samples = end
        log = recorder.communication_log
        end = len(log)
        for at in range(self._communications, end, 5):
            if log[at + 1] in recording.positions and log[at + 1] not in sampled:
                note(log[at], log[at + 1], log[at + 2])
        self._communications = end
        for channel, (times, values) in found.items():
            recording.add_noted(channel, times, values)
