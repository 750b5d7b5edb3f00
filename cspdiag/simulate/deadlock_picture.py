"""Deadlocks that a run or a proof has found, for pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cspdiag.draw.deadlock import Deadlock
from cspdiag.draw.deadlock_marks import Waiting
from cspdiag.simulate.summary import seconds

if TYPE_CHECKING:
    from cspdiag.analyses.counterexamples.counterexample import Counterexample
    from cspdiag.runtime.deadlock import DeadlockReport, WaitingProcess


def deadlock_of(report: DeadlockReport, top: str) -> Deadlock:
    """What is drawn of the report of a run whose outermost process is ``top``."""
    besides = tuple(_waiting(process) for process in report.waiting if process not in report.cycle)
    cycle = tuple(_waiting(process) for process in report.cycle)
    return Deadlock(f"deadlock at {seconds(report.time)}", top, cycle, besides)


def _waiting(process: WaitingProcess) -> Waiting:
    return Waiting(process.path, process.waits, process.place or process.source, process.channels)


def deadlock_shown_by(counterexample: Counterexample) -> Deadlock | None:
    """What is drawn of a counterexample; None where it does not end with processes that wait for ever."""
    if not counterexample.waiting:
        return None
    steps = sum(step.shown for step in counterexample.steps)
    title = f"{counterexample.failure} after {steps} step{'' if steps == 1 else 's'}"
    top = counterexample.process
    waiting = {
        each.name: Waiting(
            each.path or f"{top}.{each.name}",
            each.words.removeprefix("waits").strip(),
            None if each.span is None else str(each.span),
            each.channels,
        )
        for each in counterexample.waiting
    }
    cycle = tuple(waiting[name] for name in counterexample.ring)
    besides = tuple(each for name, each in waiting.items() if name not in counterexample.ring)
    return Deadlock(title, top, cycle, besides)
