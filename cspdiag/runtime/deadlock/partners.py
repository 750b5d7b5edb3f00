"""Which processes wait for which when nothing can continue.

A waiting process is the partner of another one if it can still reach a use of the channel at which that one waits. What
its process does once the parallel parts have ended, of which it is one, may be such a use, too; whether it is reached
depends on the other parts, so it makes no cycle.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Container, Iterator
from typing import Any

from ..channels.broadcast import Broadcast, BroadcastEnd
from ..kernel.party import Waits
from ..kernel.scheduler import Task
from .reports import DeadlockReport, WaitingProcess
from .tasks import Ends, NamesIn, channel_identity, ends_used_by, leaves, place_of_wait, source_of, words_of


def _path(task: Task) -> str:
    return "" if task.process is None else task.process.name


def report_deadlock(
    root: Task,
    now: int,
    stuck: Container[Task] | None = None,
    called: Callable[[Task], str] = _path,
    names_in: NamesIn | None = None,
) -> DeadlockReport:
    """Why nothing below ``root`` can continue or, if ``stuck`` is given, why those tasks cannot.

    ``called`` names tasks. ``names_in`` gives the names that count of a function in which a task waits for its parallel
    parts; without it, all do.
    """
    tasks = list(leaves(root))
    waits = [task.waits() for task in tasks]
    own, possible = _Users(), _Users()
    ends_around: dict[int, Ends] = {}
    for index, task in enumerate(tasks):
        ends = ends_used_by(task)
        own.add(index, ends)
        possible.add(index, ends)
        for around in _enclosing(task):  # Many tasks have the same one.
            if id(around) not in ends_around:
                ends_around[id(around)] = ends_used_by(around, names_in)
            possible.add(index, ends_around[id(around)])
    paths = [called(task) for task in tasks]
    processes = tuple(
        WaitingProcess(
            path=paths[index],
            source=source_of(task),
            place=place_of_wait(task),
            waits=words_of(waits[index]),
            channels=tuple(end.name for _, end in waits[index] if end is not None),
            partners=tuple(paths[other] for other in possible.partners(index, waits[index])),
            ended=tuple(end.owner for end in _missing_ends(waits[index]) if end.closed and not own.readers(index, end)),
            missing=tuple(end.owner for end in _missing_ends(waits[index])),
        )
        for index, task in enumerate(tasks)
    )
    waiting = {index: None for index, task in enumerate(tasks) if stuck is None or task in stuck}
    partners = [own.partners(index, waits[index]) if index in waiting else [] for index in range(len(tasks))]
    cycle = tuple(processes[index] for index in find_cycle(partners))
    others = tuple(process for index, process in enumerate(processes) if index not in waiting)
    return DeadlockReport(now, tuple(processes[index] for index in waiting), cycle, others)


class _Users:
    """Which of the waiting tasks, by their numbers, use which side of a channel."""

    def __init__(self) -> None:
        self._found: defaultdict[tuple[int, str], set[int]] = defaultdict(set)

    def add(self, index: int, ends: Ends) -> None:
        """Adds the ends that the task with that number uses."""
        for end, sides in ends.values():
            for side in sides:
                self._found[id(end), side].add(index)

    def partners(self, index: int, waits: Waits) -> list[int]:
        """The others at the other side of what a task waits for."""
        return sorted({other for end in _opposite_ends(waits) for other in self._found[end]} - {index})

    def readers(self, index: int, end: BroadcastEnd[Any]) -> set[int]:
        """The others that read from an end."""
        return self._found[id(end), "read"] - {index}


def _enclosing(task: Task) -> Iterator[Task]:
    """The tasks that wait for ``task`` to end, from the inside outwards."""
    while (parent := getattr(task.join, "_parent", None)) is not None:
        task = parent
        yield task


def _opposite_ends(waits: Waits) -> list[tuple[int, str]]:
    """Where partners would communicate, by the identity of the end and the side: the missing ends of a broadcast, or
    the other side of what is read or written.
    """
    opposite = [
        (channel_identity(end), "write" if words == "to read" else "read")
        for words, end in waits
        if end is not None and not isinstance(end, Broadcast)
    ]
    return opposite + [(id(end), "read") for end in _missing_ends(waits)]


def _missing_ends(waits: Waits) -> list[BroadcastEnd[Any]]:
    return [missing for _, end in waits if isinstance(end, Broadcast) for missing in end.missing]


def find_cycle(partners: list[list[int]]) -> list[int]:
    """A cycle of the graph, empty if it has none; depth first, without recursion."""
    state = [0] * len(partners)  # 0: not seen, 1: on the path, 2: leads to no cycle
    for start in range(len(partners)):
        path: list[int] = []
        branches: list[Iterator[int]] = []
        if state[start] == 0:
            path, branches, state[start] = [start], [iter(partners[start])], 1
        while path:
            following = next(branches[-1], None)
            if following is None:
                state[path.pop()] = 2
                branches.pop()
            elif state[following] == 1:
                return path[path.index(following) :]
            elif state[following] == 0:
                state[following] = 1
                path.append(following)
                branches.append(iter(partners[following]))
    return []
