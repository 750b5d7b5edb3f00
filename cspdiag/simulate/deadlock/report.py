"""The report of a deadlock: which processes wait, and which of them wait for each other."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from posixpath import dirname
from typing import TYPE_CHECKING

from cspdiag.network.ir.network import CoreNetwork
from cspdiag.simulate.deadlock.continuations import Continuations
from cspdiag.simulate.deadlock.waiting import Offer, WaitingRecord
from cspdiag.simulate.record.recorder import Recorder

if TYPE_CHECKING:
    from cspdiag.runtime.deadlock.reports import DeadlockReport


def deadlock_report(
    now: int, waiting: Sequence[WaitingRecord], network: CoreNetwork, recorder: Recorder
) -> DeadlockReport:
    """Which processes wait for each other; ``waiting`` are all that wait, in text order, and ``recorder`` knows which
    have ended.

    The partners of a process are those that may still be at the other side of what it waits for.
    """
    from cspdiag.runtime.deadlock.partners import find_cycle
    from cspdiag.runtime.deadlock.reports import DeadlockReport, WaitingProcess

    state = _Standstill(waiting, network, recorder)
    definitions = _definitions(network)
    partners = [state.partners(index) for index in range(len(waiting))]
    processes = tuple(
        WaitingProcess(
            path=record.path,
            source=definitions.get(record.path),
            place=record.place or None,
            waits=record.waits,
            channels=record.channels,
            partners=tuple(waiting[other].path for other in partners[index]),
            ended=state.ended(index),
        )
        for index, record in enumerate(waiting)
    )
    return DeadlockReport(now, processes, tuple(processes[index] for index in find_cycle(partners)))


def _definitions(network: CoreNetwork) -> dict[str, str]:
    """The line at which each process and control law is defined, by path."""
    folder = dirname(network.source)
    spans = {entry.name: entry.span for entry in network.classes}
    found: dict[str, str] = {}
    for item in network.instances:
        span = spans[item.class_name]
        found[item.path] = f"{span.file.removeprefix(f'{folder}/') if folder else span.file}:{span.line}"
    return found


class _Standstill:
    """What the waiting processes may still communicate, and which processes have ended."""

    def __init__(self, waiting: Sequence[WaitingRecord], network: CoreNetwork, recorder: Recorder) -> None:
        self._waiting = waiting
        self._recorder = recorder
        self._begun = {activity.path for activity in recorder.activities}
        self._broadcasts = {net.path: net for net in network.nets if net.kind == "broadcast"}
        self._continuations = Continuations(network)
        self._users: defaultdict[Offer, list[tuple[int, str]]] = defaultdict(list)
        """For each side of a channel the processes that may still be there, with the numbers of their records."""
        for index, record in enumerate(waiting):
            for use in self._continuations.of(record):
                self._users[use.offer].append((index, use.process))

    def partners(self, index: int) -> list[int]:
        """The numbers of the processes that may still take part in what a process waits for."""
        record = self._waiting[index]
        missing = self._missing(record)
        return sorted(
            {
                other
                for offer in record.offers
                for other, process in self._users[offer.opposite]
                if other != index and (process in missing or not self._is_broadcast(offer))
            }
        )

    def ended(self, index: int) -> tuple[str, ...]:
        """The readers that have ended without taking what a process writes to broadcasts, in the order of the network;
        none of them runs again.
        """
        record = self._waiting[index]
        missing = self._missing(record)
        found = []
        for offer in record.offers:
            if self._is_broadcast(offer):
                readers = [self._continuations.process_of(path) for path, _ in self._broadcasts[offer.channel].readers]
                to_come = {process for other, process in self._users[offer.opposite] if other != index}
                found += [reader for reader in readers if reader in missing - to_come and self._has_ended(reader)]
        return tuple(dict.fromkeys(found))

    def _missing(self, record: WaitingRecord) -> set[str]:
        return {self._continuations.process_of(path) for path in record.missing}

    def _is_broadcast(self, offer: Offer) -> bool:
        return offer.side == "write" and offer.channel in self._broadcasts

    def _has_ended(self, process: str) -> bool:
        return process in self._begun and process not in self._recorder.running
