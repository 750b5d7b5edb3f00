"""What processes wait for at one moment of a run, for the report of a difference."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from cspdiag.runtime.deadlock.partners import report_deadlock
from cspdiag.runtime.kernel.scheduler import Task, present
from cspdiag.simulate.record.recorder import Communication, Recorder

FIELDS = len(Communication._fields)


class ObservedRun(Recorder):
    """A recorder that notes, after a certain number of communications, what every process waits for."""

    def __init__(self, moment: int) -> None:
        super().__init__()
        self.communication_log = _Log(moment)

    @property
    def waits(self) -> tuple[str, ...] | None:
        """What each process waited for then; None if that is not known, or if there were fewer communications."""
        assert isinstance(self.communication_log, _Log)
        return self.communication_log.waits


class _Log(list[Any]):
    def __init__(self, moment: int) -> None:
        super().__init__()
        self.moment = moment
        self.waits: tuple[str, ...] | None = None

    def extend(self, fields: Iterable[Any]) -> None:
        super().extend(fields)
        if len(self) == FIELDS * self.moment:
            self.waits = _present_waits(Communication._make(self[-FIELDS:]))


def _present_waits(made: Communication) -> tuple[str, ...] | None:
    task = present().current
    if not isinstance(task, Task):
        return None
    while (parent := getattr(task.join, "_parent", None)) is not None:
        task = parent
    lines = []
    for process in report_deadlock(task, made.time).waiting:
        communicates = process.path in (made.writer, made.reader)
        lines.append(f"{process.path} communicates through {made.channel}" if communicates else str(process))
    return tuple(lines)
