"""A deadlock of a run, as a picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cspdiag.draw.deadlock import Deadlock
from cspdiag.draw.deadlock_marks import Waiting
from cspdiag.simulate.summary import seconds

if TYPE_CHECKING:
    from cspdiag.runtime.deadlock import DeadlockReport, WaitingProcess


def deadlock_of(report: DeadlockReport, top: str) -> Deadlock:
    """What is drawn of the report of a run whose outermost process is ``top``."""
    besides = tuple(_waiting(process) for process in report.waiting if process not in report.cycle)
    cycle = tuple(_waiting(process) for process in report.cycle)
    return Deadlock(f"deadlock at {seconds(report.time)}", top, cycle, besides)


def _waiting(process: WaitingProcess) -> Waiting:
    return Waiting(process.path, process.waits, process.place or process.source, process.channels)
