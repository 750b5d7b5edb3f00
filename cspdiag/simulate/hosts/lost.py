"""What a lost link does to the processes that wait for the other place: it raises ``Timeout`` in them."""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.runtime.choice.alternative import Alternative
from cspdiag.runtime.composition import Branches
from cspdiag.runtime.kernel.exceptions import Timeout
from cspdiag.runtime.kernel.scheduler import Task


def raise_in_waiting(root: Task, channels: frozenset[str], error: Exception) -> bool:
    """Raises an exception in each task below ``root`` that waits for one of the channels and, if it waits in an
    alternative, for nothing else. Returns whether there was one.
    """
    waiting = [task for task in _tasks(root) if _waits_for(task, channels)]
    raised = [_raise_in(task, error) for task in waiting]
    return any(raised)


def _tasks(root: Task) -> Iterator[Task]:
    pending = [root]
    for task in pending:
        if task.ended:
            continue
        yield task
        if isinstance(task.waiting, Branches) and task.waiting.pending:
            pending += task.waiting.tasks


def _waits_for(task: Task, channels: frozenset[str]) -> bool:
    if task.cancelled or isinstance(task.waiting, Branches):
        return False
    awaited = [end is not None and end.name in channels for _, end in task.waits()]
    return bool(awaited) and (all(awaited) if isinstance(task.waiting, Alternative) else any(awaited))


def _raise_in(task: Task, error: Exception) -> bool:
    if not task.withdraw():
        return False

    def throw(_: None) -> object:
        task.resume = task.coroutine.send
        return task.coroutine.throw(error)

    task.resume = throw
    task.ready_queue.append(task.entry)
    return True


def silence_of(place: str, seconds: float) -> Timeout:
    """What is raised because nothing has come from a place for so long."""
    error = Timeout(f"the place `{place}` has been silent for {seconds:g} s")
    error.is_of_link = True
    return error
