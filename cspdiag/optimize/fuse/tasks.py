"""Tasks as they are followed at compile time, and what they may wait for."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from cspdiag.optimize.fuse.code import Raise

Key = tuple[int, ...]


class Task:
    """A branch of a parallel, or the program; ``position`` is the instruction that it is at."""

    def __init__(self, key: Key, position: int, priority: Key, parent: Branches | None) -> None:
        self.key = key
        self.position = position
        self.priority = priority
        self.parent = parent
        self.request: Request | None = None
        self.cancelled = False
        self.ended = False

    def rank(self) -> Key:
        """Priorities are compared from the outermost ``||>`` inwards, as if zeros followed."""
        rank = self.priority
        while rank and rank[-1] == 0:
            rank = rank[:-1]
        return rank

    def state(self) -> tuple[object, ...]:
        """What its future depends on."""
        return (self.key, self.position, self.cancelled, None if self.request is None else self.request.state())


class TaskScheduler(Protocol):
    """What requests ask of the program that is followed: who runs, and when."""

    now: int
    due: int
    """Time-outs up to this instant are over."""
    memories: dict[str, int]
    """By the name of an alternative, the guard that it chose last."""

    def make_ready(self, task: Task) -> None:
        """Put into the ready queue, where it is not there yet."""

    def cancel(self, task: Task) -> None:
        """The task ends when it runs next."""

    def notice(self) -> None:
        """Wake whoever may go on now."""


class Request:
    """What a task waits for."""

    def __init__(self, world: TaskScheduler, task: Task) -> None:
        self.world = world
        self.task = task
        self.done = False

    def state(self) -> tuple[object, ...]:
        """What the future depends on."""
        return (self.done,)

    def attempt(self) -> None:
        """The task runs: go on as far as possible."""

    def may_go_on(self) -> bool:
        """Whether something that it waits for is there."""
        return False

    def abandon(self) -> None:
        """The task ends here."""
        self.world.make_ready(self.task)

    def deadlines(self) -> Sequence[int]:
        """Instants at which it may go on."""
        return ()

    def finish(self) -> None:
        """It is done."""
        self.done = True
        self.world.make_ready(self.task)


class Waiting(Request):
    """A delay; None never ends."""

    def __init__(self, world: TaskScheduler, task: Task, duration: int | None) -> None:
        super().__init__(world, task)
        self.until = None if duration is None else world.now + duration

    def state(self) -> tuple[object, ...]:
        """See ``Request.state``."""
        return (self.done, None if self.until is None else self.until - self.world.now)

    def may_go_on(self) -> bool:
        """See ``Request.may_go_on``."""
        return self.until is not None and self.until <= self.world.due

    def deadlines(self) -> Sequence[int]:
        """See ``Request.deadlines``."""
        return () if self.until is None else (self.until,)

    def attempt(self) -> None:
        """See ``Request.attempt``."""
        self.done = self.done or self.may_go_on()


class Branches(Request):
    """A parallel; it has the first exception of a branch as its ``failure``."""

    def __init__(self, world: TaskScheduler, task: Task, after: int) -> None:
        super().__init__(world, task)
        self.after = after
        self.tasks: list[Task] = []
        self.failure: Raise | None = None
        self.abandoned = False

    def state(self) -> tuple[object, ...]:
        """See ``Request.state``."""
        return (self.done, id(self.failure), self.abandoned, tuple(task.ended for task in self.tasks))

    def branch_ended(self, failure: Raise | None, cancelled: bool) -> None:
        """A branch has ended."""
        if cancelled:
            self.abandoned = True
        elif failure is not None and self.failure is None:
            self.failure = failure
            for sibling in self.tasks:
                self.world.cancel(sibling)
        if all(branch.ended for branch in self.tasks):
            self.finish()

    def abandon(self) -> None:
        """See ``Request.abandon``."""
        for task in self.tasks:
            self.world.cancel(task)
