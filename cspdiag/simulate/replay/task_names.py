"""Names of the tasks of a run that are the same in every run, by the parallel branches that lead to them."""

from __future__ import annotations

from typing import TypeAlias

from cspdiag.runtime.composition import Branches
from cspdiag.runtime.scheduler import Task

Key: TypeAlias = tuple[int, ...]
"""Names a task: the numbers of the parallel branches that lead to it from the outermost process. Tasks of one name follow each other."""


class TaskNames:
    """Names of tasks, each found once: a parallel may have thousands of branches."""

    def __init__(self) -> None:
        self._numbers: dict[Task, int] = {}

    def key(self, task: Task) -> Key:
        """The name of a task that no other has at the same time."""
        numbers: list[int] = []
        join = task.join
        while isinstance(join, Branches):
            numbers.append(self._number(task, join))
            task = join._parent
            join = task.join
        return tuple(reversed(numbers))

    def told(self, task: Task) -> tuple[str, ...]:
        """What a trace may call a task: the path of the process that it executes, and its number among the parallel branches of that."""
        path = path_of(task)
        join = task.join
        while isinstance(join, Branches) and len(join.tasks) == 1:
            task = join._parent
            join = task.join
        return (path, f"{path}.{self._number(task, join) + 1}") if isinstance(join, Branches) else (path,)

    def called(self, task: Task) -> str:
        """What proofs call a task that has no other name: its process, or that with its number if it is a parallel branch inside of it."""
        path = path_of(task)
        join = task.join
        while isinstance(join, Branches):
            parent = join._parent
            if path_of(parent) != path:
                return path
            if len(join.tasks) > 1:
                return f"{path}.{self._number(task, join) + 1}"
            task, join = parent, parent.join
        return path

    def _number(self, task: Task, join: Branches) -> int:
        if task not in self._numbers:
            self._numbers.update((branch, number) for number, branch in enumerate(join.tasks))
        return self._numbers[task]


def path_of(task: Task) -> str:
    """The path of the process that a task executes."""
    return "" if task.process is None else task.process.name
