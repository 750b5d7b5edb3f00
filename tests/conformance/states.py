"""What processes wait for at one moment of a run, for the report of a difference."""

from __future__ import annotations

from cspdiag.runtime.deadlock import report_deadlock
from cspdiag.runtime.scheduler import Task, scheduler
from cspdiag.simulate.recorder import Recorder


class ObservedRun(Recorder):
    """A recorder that looks, once a number of communications has been made, at what every process waits for."""

    def __init__(self, moment: int) -> None:
        super().__init__()
        self.moment = moment
        self.waits: tuple[str, ...] | None = None

    def communication(self, time: int, channel: str, value: object, writer: str, reader: str) -> None:
        """See ``Recorder.communication``."""
        super().communication(time, channel, value, writer, reader)
        if len(self.communications) == self.moment:
            self.waits = _present_waits(time, channel, {writer, reader})


def _present_waits(now: int, channel: str, parties: set[str]) -> tuple[str, ...] | None:
    task = scheduler.current
    if not isinstance(task, Task):
        return None
    while (parent := getattr(task.join, "_parent", None)) is not None:
        task = parent
    lines = []
    for process in report_deadlock(task, now).waiting:
        lines.append(f"{process.path} communicates through {channel}" if process.path in parties else str(process))
    return tuple(lines)
