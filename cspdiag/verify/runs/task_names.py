"""Names of the tasks of a run that are the same in every run, by the parallel branches that lead to them."""

from __future__ import annotations

from typing import Any, TypeAlias

from cspdiag.runtime.composition import Branches, parallel, prioritized_parallel
from cspdiag.runtime.kernel.party import Party
from cspdiag.runtime.kernel.scheduler import Task

Key: TypeAlias = tuple[int, ...]
"""Names a task: the numbers of the parallel branches that lead to it from the outermost process. Tasks of one name
follow each other.
"""


_PARALLELS = (parallel.__code__, prioritized_parallel.__code__)


class TaskNames:
    """Names of tasks, each found once: a parallel may have thousands of branches."""

    def __init__(self) -> None:
        self._numbers: dict[Task, int] = {}
        self._positions: dict[Task, int] = {}

    def key(self, task: Task) -> Key:
        """The name of a task that no other has at the same time."""
        numbers: list[int] = []
        join = task.join
        while isinstance(join, Branches):
            numbers.append(self._number(task, join))
            task = join._parent
            join = task.join
        return tuple(reversed(numbers))

    def possible_names(self, task: Task) -> tuple[str, ...]:
        """The possible names of a task in a trace: the path of the process that it executes and, for a parallel branch
        of it, that path with the number of the branch.
        """
        path = path_of(task)
        join = task.join
        while isinstance(join, Branches) and len(join.tasks) == 1:
            task = join._parent
            join = task.join
        return (path, f"{path}.{self._position(task, join) + 1}") if isinstance(join, Branches) else (path,)

    def called(self, task: Task) -> str:
        """The name in proofs of a task that has no other name: its process, with the number of the branch if it is a
        parallel branch in it.
        """
        path = path_of(task)
        join = task.join
        while isinstance(join, Branches):
            parent = join._parent
            if path_of(parent) != path:
                return path
            if len(join.tasks) > 1:
                return f"{path}.{self._position(task, join) + 1}"
            task, join = parent, parent.join
        return path

    def _position(self, task: Task, join: Branches) -> int:
        """The number of a branch; the branches of a branch that is itself only a parallel count as branches of the
        outer one.
        """
        self._number(task, join)
        parent = join._parent
        outer = parent.join
        inside = _parallel_of(parent.coroutine) is not None and isinstance(outer, Branches)
        return self._positions[task] + (self._position(parent, outer) if inside and isinstance(outer, Branches) else 0)

    def _number(self, task: Task, join: Branches) -> int:
        if task not in self._numbers:
            position = 0
            for number, branch in enumerate(join.tasks):
                self._numbers[branch], self._positions[branch] = number, position
                position += _width(branch.coroutine)
        return self._numbers[task]


def path_of(task: Task) -> str:
    """The path of the process that a task executes."""
    return "" if task.process is None else task.process.name


def task_of(party: Party) -> Task:
    """The task on whose behalf a party waits."""
    if isinstance(party, Task):
        return party
    of: Any = party
    task: Task = of.task if hasattr(of, "task") else of._choice.task
    return task


def _parallel_of(body: object) -> tuple[object, ...] | None:
    """The branches of a body that is only a parallel, while it runs; None for others."""
    frame = getattr(body, "cr_frame", None)
    if frame is not None:
        body = frame.f_locals.get("body")
    if getattr(body, "gi_code", None) not in _PARALLELS:
        return None
    inside = getattr(body, "gi_frame", None)
    return None if inside is None else tuple(inside.f_locals["bodies"])


def _width(body: object) -> int:
    """The number of branches that a branch counts for."""
    branches = _parallel_of(body)
    return 1 if branches is None else sum(map(_width, branches))
