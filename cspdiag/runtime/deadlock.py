"""The report of a deadlock: who waits for what."""

from __future__ import annotations

from dataclasses import dataclass

from .composition import Branches
from .scheduler import Task


@dataclass(frozen=True)
class WaitingProcess:
    """A process that can never go on: its path, the source line of its definition, and what it waits for."""

    path: str
    source: str | None
    waits: str

    def __str__(self) -> str:
        place = "" if self.source is None else f" ({self.source})"
        return f"{self.path}{place} waits {self.waits}"


@dataclass(frozen=True)
class DeadlockReport:
    """``cycle`` are the processes that wait for each other, each for the next; ``waiting`` are all that wait."""

    waiting: tuple[WaitingProcess, ...]
    cycle: tuple[WaitingProcess, ...]

    @property
    def text(self) -> str:
        """For people, a line a process."""
        lines = [f"  {process}" for process in self.waiting]
        return "\n".join(["deadlock: no process can ever go on", *lines])


def leaves(task: Task) -> list[Task]:
    """The tasks below ``task`` that wait for anything but their own branches, in text order."""
    if isinstance(task.waiting, Branches) and task.waiting.pending:
        return [leaf for branch in task.waiting.tasks if not branch.ended for leaf in leaves(branch)]
    return [task]


def report_deadlock(root: Task) -> DeadlockReport:
    """Why nothing goes on."""
    waiting = []
    for task in leaves(root):
        process = task.process
        waits = "" if task.waiting is None else task.waiting.waits_for(task)
        waiting.append(
            WaitingProcess("" if process is None else process.name, None if process is None else process.source, waits)
        )
    return DeadlockReport(tuple(waiting), ())
