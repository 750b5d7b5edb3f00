"""Deadlocks found by a run or a proof, for pictures."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from cspdiag.draw.deadlock.marks import StuckProcess
from cspdiag.draw.deadlock.ring import Deadlock
from cspdiag.runtime.kernel.durations import shown

if TYPE_CHECKING:
    from cspdiag.base import Span
    from cspdiag.network.ir.network import CoreNetwork
    from cspdiag.proofs.counterexamples.counterexample import Counterexample
    from cspdiag.runtime.deadlock.reports import DeadlockReport, WaitingProcess


def deadlock_of(report: DeadlockReport, network: CoreNetwork) -> Deadlock:
    """What is drawn for the report of a run of a network."""
    users = {net.path: (*net.writers, *net.readers) for net in network.nets}
    besides = tuple(_waiting(process, users) for process in report.besides)
    cycle = tuple(_waiting(process, users) for process in report.cycle)
    return Deadlock(f"deadlock at {shown(report.time)}", network.top, cycle, besides, _declared(network))


def _declared(network: CoreNetwork | None) -> dict[str, Span]:
    return {} if network is None else {net.path: net.span for net in network.nets}


def _waiting(process: WaitingProcess, users: Mapping[str, Iterable[tuple[str, str]]]) -> StuckProcess:
    ports = (port for channel in process.channels for path, port in users.get(channel, ()) if path == process.path)
    place = process.place or process.source
    return StuckProcess(process.path, process.waits, place, process.channels, tuple(dict.fromkeys(ports)))


def deadlock_shown_by(counterexample: Counterexample, network: CoreNetwork | None) -> Deadlock | None:
    """What is drawn for a counterexample of a network; None if it does not end with processes that wait forever."""
    if not counterexample.waiting:
        return None
    steps = sum(step.shown for step in counterexample.steps)
    title = f"{counterexample.failure} after {steps} step{'' if steps == 1 else 's'}"
    top = counterexample.process
    waiting = {
        each.name: StuckProcess(
            each.path or f"{top}.{each.name}",
            each.words.removeprefix("waits").strip(),
            None if each.span is None else str(each.span),
            each.channels,
            span=each.span,
        )
        for each in counterexample.waiting
    }
    cycle = tuple(waiting[name] for name in counterexample.ring)
    besides = tuple(each for name, each in waiting.items() if name not in counterexample.ring)
    return Deadlock(title, top, cycle, besides, _declared(network))
