"""Composition: parallel, prioritized parallel, groups, delays.

Invariants of a parallel: its branches enter the ready queue in text order; the parent is readied when the last branch
has ended, and not before, whatever happened; the first exception of a branch cancels the other branches and is what the
parallel raises.
"""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Coroutine, Generator
from contextlib import suppress
from functools import partial
from inspect import iscoroutine, ismethod
from types import CoroutineType, FunctionType, MethodType, coroutine
from typing import Any, TypeAlias, TypeVar

from .compiled.routine import Branch, Routine, routine_task
from .kernel.exceptions import ANOTHER_BRANCH, Cancelled, kind_and_text, run_is_ended
from .kernel.party import Party, Waits
from .kernel.policy import Option
from .kernel.scheduler import Join, Task, hold, present
from .kernel.timers import begin_delay
from .process import Process

T = TypeVar("T")

Body: TypeAlias = "Awaitable[object] | Branch | Callable[[], Awaitable[object]]"
"""What can run in parallel with others. A method that makes a coroutine is called only when the branch begins, so no
coroutine is left over if something fails earlier.
"""


class Branches:
    """The branches of a parallel, and the parent that waits for their end.

    ``cancelled`` is whether a branch was ended by a cancellation.
    """

    __slots__ = ("_abandoned", "_error", "_parent", "cancelled", "pending", "tasks")

    def __init__(self, parent: Task) -> None:
        self.tasks: list[Task] = []
        self._parent = parent
        self.pending = 0
        self._error: BaseException | None = None
        self._abandoned = False
        self.cancelled = False

    def start(self, bodies: tuple[Body, ...], *, prioritized: bool = False) -> None:
        """Makes the branches and puts them into the ready queue."""
        parent = self._parent
        self.tasks = [self._task_for(body) for body in bodies]
        self.pending = len(self.tasks)
        if prioritized:
            for rank, task in enumerate(self.tasks):
                parent.scheduler.set_priority(task, (*parent.priority, rank))
        for task in self.tasks:
            task.ready_queue.append(task.entry)

    def _task_for(self, body: Body) -> Task:
        """What executes a branch."""
        return task_for(body, self, self._parent)

    def wait(self) -> Generator[None, None, None]:
        """Waits for all; raises what the first unsuccessful one raised."""
        if not self.pending:
            return
        self._parent.waiting = self
        yield
        if self._error is not None:
            raise self._error
        if self._abandoned and self.cancelled:
            raise Cancelled

    def branch_ended(self, branch: Task, error: BaseException | None) -> None:
        """See ``Join.branch_ended``."""
        self.pending -= 1
        if isinstance(error, Cancelled):
            self.cancelled = True
        elif error is not None:
            if self._error is None:
                self._error = error
                branch.scheduler.cancel(task for task in self.tasks if task is not branch)
            else:
                self._error.add_note(f"{ANOTHER_BRANCH} {kind_and_text(error)}")
        if not self.pending:
            self._parent.ready_queue.append(self._parent.entry)

    def withdraw(self, party: Party) -> bool:
        """Cancels the branches. Always False: the last branch that ends readies the parent."""
        if self.pending:
            self._abandoned = True
            self._parent.scheduler.cancel(self.tasks)
        return False

    def waits_for(self, party: Party) -> Waits:
        """See ``Waiting.waits_for``."""
        return (("for its parallel branches to end", None),)


class Rounds(Branches):
    """A parallel of optimized code that is run again and again: its tasks are made once.

    The code of each branch calls ``done`` where the branch ends, and begins again when it is resumed. ``failed``:
    whether the parent has to call ``conclude`` when it continues.
    """

    __slots__ = ("_bodies", "failed")

    def __init__(self, parent: Task, *bodies: Branch) -> None:
        super().__init__(parent)
        self._bodies = bodies
        self.failed = False

    def begin(self) -> None:
        """Puts the branches into the ready queue; the parent then waits."""
        if not self.tasks:
            self.tasks = [routine_task(body, self, self._parent) for body in self._bodies]
        self.pending = len(self.tasks)
        for task in self.tasks:
            task.ended = False
            task.ready_queue.append(task.entry)
        self._parent.waiting = self

    def done(self, branch: Task) -> None:
        """A branch has ended; it now waits to be resumed."""
        branch.ended = True
        self.pending -= 1
        if not self.pending:
            self._parent.ready_queue.append(self._parent.entry)

    def branch_ended(self, branch: Task, error: BaseException | None) -> None:
        """See ``Branches.branch_ended``: this branch will not begin again."""
        self.failed = True
        super().branch_ended(branch, error)

    def conclude(self) -> None:
        """Raises what the first unsuccessful branch raised."""
        for task in self.tasks:
            task.scheduler.forget(task)
        self.tasks = []
        self.failed = False
        error, self._error = self._error, None
        cancelled, self.cancelled = self.cancelled, False
        if error is not None:
            raise error
        if self._abandoned and cancelled:
            raise Cancelled


def end_all(task: Task) -> None:
    """Closes the coroutines of a task and of all below it, innermost first, when a run is over."""
    tasks = [task]
    for parent in tasks:
        if isinstance(parent.waiting, Branches) and parent.waiting.pending:
            tasks += [branch for branch in parent.waiting.tasks if not branch.ended]
    for ending in reversed(tasks):
        ending.ended = True
        # close() raises if code continues to communicate in a ``finally``; there is nothing left to communicate with.
        with suppress(Exception, Cancelled):
            ending.coroutine.close()


async def _awaited(body: Awaitable[T]) -> T:
    return await body


def task_for(body: Body, join: Join, parent: Task | None) -> Task:
    """What executes ``body``."""
    made: Any = body
    if type(made) is MethodType:
        return Task(as_coroutine(made()), join, parent)
    if isinstance(made, partial):
        return Task(as_coroutine(made()), join, parent) if ismethod(made.func) else routine_task(made, join, parent)
    if type(made) is FunctionType or isinstance(made, Routine):
        return routine_task(made, join, parent)
    return Task(as_coroutine(made), join, parent)


def _begun(body: Body) -> Coroutine[Any, Any, object]:
    made: Any = body
    return as_coroutine(made() if ismethod(made.func if isinstance(made, partial) else made) else made)


def as_coroutine(body: Awaitable[T]) -> Coroutine[Any, Any, T]:
    """What a task can execute."""
    if isinstance(body, CoroutineType):
        return body
    if isinstance(body, Process):
        return body.execute()
    return _awaited(body)


@coroutine
def parallel(*bodies: Body) -> Generator[None, None, None]:
    """Runs processes or coroutines at the same time; ends when all have ended.

    If one raises an exception, the others are cancelled at their next communication, and it is raised here when they
    have ended; exceptions of those are added to it as notes.
    """
    task = _parent_of(bodies)
    branches = Branches(task)
    branches.start(bodies)
    yield from branches.wait()


@coroutine
def prioritized_parallel(*bodies: Body) -> Generator[None, None, None]:
    """Like ``parallel``; each branch has a higher priority than those after it.

    The first keeps the priority of the parent. A branch of rank r runs only when no branch of a lower rank, nor any of
    its inner branches, is ready.
    """
    task = _parent_of(bodies)
    branches = Branches(task)
    branches.start(bodies, prioritized=True)
    yield from branches.wait()


def _parent_of(bodies: tuple[Body, ...]) -> Task:
    task = present().current
    if task.cancelled:
        for body in bodies:
            if iscoroutine(body):
                body.close()
        raise Cancelled
    return task


@coroutine
def group(label: str, body: Body) -> Generator[Any, Any, None]:
    """Runs ``body`` under a label, for traces and progress."""
    scheduler = present()
    watcher = scheduler.watcher
    if watcher is None:
        yield from _begun(body)
        return
    process = scheduler.current.process
    path = label if process is None else f"{process.name}.{label}"
    watcher.group_started(scheduler.now, path)
    try:
        yield from _begun(body)
    finally:
        if not run_is_ended():
            watcher.group_ended(scheduler.now, path)


def now() -> int:
    """The present instant, in nanoseconds from the start."""
    return present().now


@coroutine
def wait(duration: int) -> Generator[None, None, None]:
    """A delay in nanoseconds; one of zero or less ends at once."""
    scheduler = present()
    policy = scheduler.policy
    over = None if policy is None else (yield from hold(policy, Option("wait", duration=duration)))
    task = scheduler.current
    if task.cancelled:
        raise Cancelled
    if duration > 0 and over is None:
        begin_delay(task, duration)
        yield
    if policy is not None:
        policy.did(task, Option("wait", duration=duration))


class _Stop:
    """Waits for nothing."""

    def withdraw(self, party: Party) -> bool:
        return True

    def waits_for(self, party: Party) -> Waits:
        return (("forever, at stop", None),)


@coroutine
def stop() -> Generator[None, None, None]:
    """Never ends."""
    task = present().current
    if task.cancelled:
        raise Cancelled
    task.waiting = _Stop()
    yield
