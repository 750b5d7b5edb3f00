"""Interrupt: a process that is abandoned at its next communication once a guard is ready."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Generator
from types import coroutine
from typing import Any

from .alternative import Alternative
from .choice import Choice, Guard, Input, Output
from .composition import Branches
from .exceptions import Cancelled
from .scheduler import Task, scheduler


class _Interruption(Choice):
    """The guard of an interrupt: it does not wake a task that waits, it cancels the body."""

    body: Task

    def wake(self) -> None:
        """The guard has become ready."""
        self.woken = True
        self.body.cancel()


@coroutine
def interrupt(
    body: Awaitable[object], guard: Guard, handler: Callable[[], Awaitable[object]]
) -> Generator[None, None, None]:
    """Runs ``body``; once ``guard`` is ready, abandons it at its next communication, and then runs ``handler``.

    The communication of the guard is made when the body has ended. If the body ends by itself, nothing else happens. An ``Input`` guard keeps
    what it read as its ``value``.
    """
    task = scheduler.current
    if task.cancelled:
        raise Cancelled
    branches = Branches(task)
    branches.start((body,))
    interruption = _Interruption((guard,))
    interruption.body = branches.tasks[0]
    interruption.begin_waiting(task, 1, {}, {})
    if interruption.selector.ready or interruption.time_outs_passed(1, {}):
        interruption.wake()
    try:
        yield from branches.wait()
    finally:
        interruption.end_waiting()
        interruption.give_up()
    if interruption.chosen >= 0:
        value = interruption.value
    elif interruption.woken and branches.cancelled:
        value = yield from _communication(guard)
    else:
        return  # The body came to its end before its next communication.
    if isinstance(guard, Input):
        guard.value = value
    yield from handler().__await__()


def _communication(guard: Guard) -> Generator[None, None, Any]:
    """What the guard reads or writes; it waits if somebody else was faster."""
    if not isinstance(guard, Input | Output):
        return None
    alternative = Alternative(guard)
    yield from alternative.select()
    return alternative.value
