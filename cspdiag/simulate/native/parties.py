"""The writer and the reader of a communication, if a native program knows only the process into which they were
inlined.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable

from cspdiag.network.ir.network import CoreNetwork, SubmodelClass


class Parties:
    """Finds the writer or reader of a communication in the diagram. ``running`` are the paths of the running
    processes.
    """

    def __init__(self, network: CoreNetwork, running: Collection[str]) -> None:
        self._running = running
        laws = {entry.name for entry in network.classes if isinstance(entry, SubmodelClass)}
        self._laws = {item.path for item in network.instances if item.class_name in laws}
        self._users = {
            "write": {net.path: _paths(net.writers) for net in network.nets},
            "read": {net.path: _paths(net.readers) for net in network.nets},
        }
        self._candidates: dict[tuple[str, str, str], tuple[str, ...]] = {}

    def writer(self, channel: str, process: str) -> str:
        """The path of the writer, in or at ``process``."""
        return self._find("write", channel, process)

    def reader(self, channel: str, process: str) -> str:
        """The path of the reader, in or at ``process``."""
        return self._find("read", channel, process)

    def _find(self, direction: str, channel: str, process: str) -> str:
        if not process:
            return process
        key = (direction, channel, process)
        candidates = self._candidates.get(key)
        if candidates is None:
            users = self._users[direction].get(channel, ())
            candidates = tuple(user for user in users if user == process or user.startswith(f"{process}."))
            self._candidates[key] = candidates
        if not candidates:
            return process
        if len(candidates) == 1:
            return candidates[0]
        # Of a process and its law it is the law, which communicates in every sample, the process only when it begins
        # and ends. Which of several laws or processes it is, is not in the record: it is one of ``process``.
        active = [user for user in candidates if self._process_of(user) in self._running]
        likely = [user for user in active if user in self._laws] or active
        return likely[0] if len(likely) == 1 else process

    def _process_of(self, user: str) -> str:
        return user.rpartition(".")[0] if user in self._laws else user


def _paths(users: Iterable[tuple[str, str]]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(path for path, _ in users))
