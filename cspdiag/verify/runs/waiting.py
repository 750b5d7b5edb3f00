"""Where the processes of a step that does not happen wait instead, in the words of the diagram."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

from cspdiag.runtime.deadlock.tasks import leaves, place_of_wait, words_of
from cspdiag.runtime.kernel.scheduler import Task
from cspdiag.verify.runs.names import UNFIT, fit, is_medium
from cspdiag.verify.runs.task_names import TaskNames, path_of
from cspdiag.verify.runs.trace import TraceStep

_MOST_NAMED = 3
"""The number of processes that the sentence names; it leaves out others."""


def where_instead(step: TraceStep, root: Task, names: TaskNames, top: str) -> str:
    """Where those tasks below ``root`` wait that fit the parties of a step best; "" if there are none.

    Channels have their names below the outermost process ``top``.
    """
    if root.ended:
        return "the program has ended"
    found = dict.fromkeys(_fitting(step, [_Waiting(task, names) for task in leaves(root)]))
    return "; ".join([waiting.sentence(top) for waiting in islice(found, _MOST_NAMED)])


def _fitting(step: TraceStep, candidates: list[_Waiting]) -> Iterator[_Waiting]:
    for name, path in step.parties:
        if not is_medium(name, step):
            ranks = [fit(waiting, name, path) for waiting in candidates]
            best = min(ranks, default=UNFIT)
            yield from (waiting for waiting, rank in zip(candidates, ranks, strict=True) if rank == best < UNFIT)


class _Waiting:
    """A task that waits, for comparison with names in a trace."""

    def __init__(self, task: Task, names: TaskNames) -> None:
        self._task = task
        self._names = names

    @property
    def path(self) -> str:
        """The process that the task executes."""
        return path_of(self._task)

    @property
    def names(self) -> tuple[str, ...]:
        """What a trace may call it."""
        return self._names.possible_names(self._task)

    def sentence(self, top: str) -> str:
        """Name, what it waits for, and where."""
        words = words_of(self._task.waits()).replace(f" {top}.", " ")
        verb = "is" if words.startswith("in ") else "waits"
        place = place_of_wait(self._task)
        return f"`{self._names.called(self._task)}` {verb} {words}" + ("" if place is None else f" ({place})")
