"""A scheduler for programs that are optimized code altogether: it resumes their generators directly.

They are in the ready queue themselves, so that a loop in C goes through them; a task is looked up when its code has
ended, or has failed. What else is in the queue are parties that are resumed by ``__next__``: tasks that were cancelled,
and what waits for one of several communications.

The code itself sets the current task before it calls a function that needs it. Programs with parts written by hand,
which need to know at any time which task runs, and those with levels of priority have a plain ``Scheduler``.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import islice
from operator import length_hint
from typing import Any, Final

from ..kernel.party import Entry
from ..kernel.scheduler import Priority, Scheduler, Task, nobody

FEW: Final = 16
"""How many entries are resumed by a loop in Python, which begins faster than the one in C: at most instants there are
no more.
"""


class _Spent:
    """Takes the place, in a ready queue, of a communication of a task that was cancelled."""

    def resume(self, _: None) -> None:
        pass

    def __next__(self) -> None:
        pass


SPENT: Final[Any] = _Spent()


class DirectScheduler(Scheduler):
    """``tasks`` has the task of each generator that has not ended. ``displaced`` has the generators of cancelled tasks,
    each with what takes the last of its places in the queue, and what takes the others.
    """

    __slots__ = ("displaced", "tasks")

    def __init__(self) -> None:
        super().__init__()
        self.tasks: dict[Any, Task] = {}
        self.displaced: dict[Any, tuple[Entry, Entry]] = {}

    def run_ready(self, most: int = 4096) -> bool:
        """See ``Scheduler.run_ready``; ``most`` is at least ``FEW``."""
        queue = self.queue
        if not queue:
            return False
        few = islice(queue, FEW)
        entry: Any = nobody
        while True:
            try:
                for entry in few:
                    next(entry)
                break
            except StopIteration:
                self._ended(entry, None)
            except BaseException as error:
                self._ended(entry, error)
        self.current = nobody
        if len(queue) <= FEW:
            queue.clear()
            return False
        self._run_many(most)
        del queue[:most]
        self.current = nobody
        return bool(queue)

    def _run_one(self, party: Any) -> None:
        try:
            next(party)
        except StopIteration:
            self._ended(party, None)
        except BaseException as error:
            self._ended(party, error)

    def _run_many(self, most: int) -> None:
        """Resumes the entries after the first few. The StopIteration of a generator ends ``any``, but not the batch."""
        entries = iter(self.queue)
        batch = map(next, islice(entries, FEW, most))
        while True:
            try:
                any(batch)
            except BaseException as error:
                self._ended(self._last(entries), error)
            else:
                last = self._last(entries)
                if not self._has_ended(last):
                    return
                self._ended(last, None)

    def _last(self, entries: Iterator[Entry]) -> Entry:
        """The entry that was resumed last."""
        entry: Entry = self.queue[len(self.queue) - length_hint(entries) - 1]
        return entry

    def _has_ended(self, entry: Entry) -> bool:
        """Whether the code behind an entry that was resumed has ended just now."""
        task = self.tasks.get(entry, self.current)
        return task is not nobody and not task.ended and not _has_frame(task.coroutine)

    def _ended(self, entry: Entry, error: BaseException | None) -> None:
        task = self.current = self.tasks.get(entry, self.current)
        if task is not nobody:
            self.forget(task)
        self._task_ended(error)

    def forget(self, task: Task) -> None:
        """See ``Scheduler.forget``."""
        self.tasks.pop(task.coroutine, None)

    def set_priority(self, task: Task, priority: Priority) -> None:
        """See ``Scheduler.set_priority``: not here."""
        raise NotImplementedError("a program with levels of priority is tracked")

    def cancel(self, tasks: Iterable[Task]) -> None:
        """See ``Scheduler.cancel``. A generator that has offered several communications at once has several entries."""
        super().cancel(tasks)
        displaced, self.displaced = self.displaced, {}
        if not displaced:
            return
        queue = self.queue
        for position in range(len(queue) - 1, -1, -1):
            entry = queue[position]
            if entry in displaced:
                queue[position], others = displaced[entry]
                displaced[entry] = others, others


def _has_frame(code: Any) -> bool:
    """Whether a generator or a coroutine has not ended."""
    return getattr(code, "gi_frame", None) is not None or getattr(code, "cr_frame", None) is not None
