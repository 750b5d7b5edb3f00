"""The report of a deadlock of a native program, as for one in Python."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from cspdiag.network.ir.network import Network
from cspdiag.simulate.native.stream import WaitingRecord

if TYPE_CHECKING:
    from cspdiag.runtime.deadlock import DeadlockReport


def deadlock_report(now: int, waiting: Sequence[WaitingRecord], network: Network) -> DeadlockReport:
    """Who waits for whom; partners are those among the waiting that the network connects to the channel."""
    from cspdiag.runtime.deadlock import DeadlockReport, WaitingProcess, find_cycle

    users = {net.path: {path for path, _ in (*net.writers, *net.readers)} for net in network.nets}
    partners = [
        [
            other
            for other, candidate in enumerate(waiting)
            if other != index and any(_uses(candidate.path, channel, users) for channel in record.channels)
        ]
        for index, record in enumerate(waiting)
    ]
    processes = tuple(
        WaitingProcess(
            path=record.path,
            source=record.source or None,
            place=record.place or None,
            waits=_words(record),
            channels=record.channels,
            partners=tuple(waiting[other].path for other in partners[index]),
        )
        for index, record in enumerate(waiting)
    )
    return DeadlockReport(now, processes, tuple(processes[index] for index in find_cycle(partners)))


def _uses(path: str, channel: str, users: Mapping[str, set[str]]) -> bool:
    return any(user == path or user.startswith(f"{path}.") for user in users.get(channel, ()))


def _words(record: WaitingRecord) -> str:
    """``to read Ring.link[2]`` of ``Ring.cell[3] waits to read Ring.link[2] (ring.csp:12)``."""
    text = record.words.removeprefix(f"{record.path} waits ")
    return text.removesuffix(f" ({record.place})") if record.place else text
