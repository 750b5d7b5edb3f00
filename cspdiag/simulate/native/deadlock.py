"""The report of a deadlock of a native program, in the form of those of Python programs."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import TYPE_CHECKING

from cspdiag.network.ir.network import CoreNetwork, Net, ProcessClass, SubmodelClass
from cspdiag.network.relations import end_key
from cspdiag.semantics.ends import ends_read
from cspdiag.simulate.native.stream import WaitingRecord
from cspdiag.simulate.record.recorder import Recorder

if TYPE_CHECKING:
    from cspdiag.runtime.deadlock import DeadlockReport


def deadlock_report(
    now: int, waiting: Sequence[WaitingRecord], network: CoreNetwork, recorder: Recorder
) -> DeadlockReport:
    """Which processes wait for each other. Partners are the waiting processes that the network connects to the channel,
    for a broadcast those on its other side; ``recorder`` knows which have ended.
    """
    from cspdiag.runtime.deadlock import DeadlockReport, WaitingProcess, find_cycle

    nets = {net.path: net for net in network.nets}
    processes_begun = {activity.path for activity in recorder.activities}
    laws = {entry.name for entry in network.classes if isinstance(entry, SubmodelClass)}
    begun = processes_begun | {
        item.path for item in network.instances if item.class_name in laws and _enclosing(item.path) in processes_begun
    }
    ends = _broadcast_ends(network)
    missing = [_missing_readers(record, ends) for record in waiting]
    awaited = [_opposite(record, nets) | set(readers) for record, readers in zip(waiting, missing, strict=True)]
    partners = [
        [
            other
            for other, candidate in enumerate(waiting)
            if other != index
            and any(_runs(candidate.path, user, processes_begun) for user in awaited[index])
            and not _waits_alike(record, candidate)
        ]
        for index, record in enumerate(waiting)
    ]
    ended = [
        tuple(
            reader
            for reader in readers
            if reader in begun
            and reader != record.path
            and not any(_runs(other.path, reader, processes_begun) for other in waiting if other is not record)
        )
        for record, readers in zip(waiting, missing, strict=True)
    ]
    processes = tuple(
        WaitingProcess(
            path=record.path,
            source=record.source or None,
            place=record.place or None,
            waits=_words(record),
            channels=record.channels,
            partners=tuple(waiting[other].path for other in partners[index]),
            ended=ended[index],
        )
        for index, record in enumerate(waiting)
    )
    return DeadlockReport(now, processes, tuple(processes[index] for index in find_cycle(partners)))


def _broadcast_ends(network: CoreNetwork) -> dict[str, list[str]]:
    """For each broadcast the process at each of its reading ends, in the order of their numbers: a process in which
    parallel parts read it has several.
    """
    classes = {entry.name: entry for entry in network.classes}
    instances = {item.path: classes[item.class_name] for item in network.instances}
    found: dict[str, list[str]] = {}
    for net in network.nets:
        if net.kind == "broadcast":
            ends = found.setdefault(net.path, [])
            for path, key in net.readers:
                entry = instances[path]
                body = entry.body if isinstance(entry, ProcessClass) else None
                own = set() if body is None else {end for end in ends_read(body) if end_key(end) == key}
                ends += [path] * max(len(own), 1)
    return found


def _missing_readers(record: WaitingRecord, ends: Mapping[str, Sequence[str]]) -> tuple[str, ...]:
    """The readers that have not taken what the process writes to broadcasts, each once."""
    channels = zip(record.channels, record.missing, strict=True)
    return tuple(dict.fromkeys(ends[channel][index] for channel, missing in channels for index in missing))


def _opposite(record: WaitingRecord, nets: Mapping[str, Net]) -> set[str]:
    """The processes that may reach the other side of what the process waits for, except for the readers that its
    broadcasts miss.
    """
    words = _words(record).split(" or ")
    found: set[str] = set()
    for channel in record.channels:
        net = nets[channel]
        if f"to read {channel}" in words:
            found.update(path for path, _ in net.writers)
        if f"to write {channel}" in words and net.kind != "broadcast":
            found.update(path for path, _ in net.readers)
    return found


def _enclosing(path: str) -> str:
    return path.rpartition(".")[0]


def _runs(path: str, user: str, begun: Collection[str]) -> bool:
    """Whether a process is this user of a channel, or runs it inlined, as a part of itself."""
    while user != path and user and user not in begun:
        user = _enclosing(user)
    return user == path


def _waits_alike(record: WaitingRecord, other: WaitingRecord) -> bool:
    """Whether two parallel parts of one process wait for the same thing: neither reaches the other side meanwhile."""
    return record.path == other.path and _words(record) == _words(other)


def _words(record: WaitingRecord) -> str:
    """``to read Ring.link[2]`` of ``Ring.cell[3] waits to read Ring.link[2] (ring.csp:12)``."""
    text = record.words.removeprefix(f"{record.path} waits ")
    return text.removesuffix(f" ({record.place})") if record.place else text
