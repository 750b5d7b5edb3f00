"""Interrupt: a process that is abandoned at its next communication once a guard is ready."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Generator
from inspect import iscoroutine
from types import coroutine
from typing import Any, cast

from ..compiled.routine import Branch, CheckedTask, RoutineTask
from ..composition import Body, Branches
from ..kernel.exceptions import Cancelled
from ..kernel.party import Party, Waits
from ..kernel.policy import Option, Policy
from ..kernel.scheduler import Task, present
from .alternative import Alternative
from .guards import Choice, Guard, Input, Output, Ready, option_of, waits_of_guard


class _Interruption(Choice):
    """The guard of an interrupt: instead of waking a task that waits, it cancels the body."""

    body: Task
    body_has_ended = False

    def wake(self) -> None:
        """The guard has become ready."""
        self.woken = True
        self.body.scheduler.cancel((self.body,))

    def pledge(self, index: int) -> Party:
        """See ``Choice.pledge``; the body runs on to its next communication while the value waits to be read."""
        party = super().pledge(index)
        self.wake()
        return party

    def redeem(self) -> None:
        """See ``Choice.redeem``: before the body has ended, no task waits for it."""
        if self.body_has_ended:
            super().redeem()

    def retract(self) -> None:
        """Withdraws the guard, even if it was promised to a reader."""
        if self.selector.waiting is not None:
            self.end_waiting()
        if self.pledged is not None and self.pledged.end.withdraw(self.pledged):
            self.pledged = None
            self.chosen = -1

    def withdraw(self, party: Party) -> bool:
        """See ``Waiting.withdraw``: the body has ended, and the value waits to be read."""
        self.retract()
        return self.pledged is None

    def waits_for(self, party: Party) -> Waits:
        """See ``Waiting.waits_for``."""
        return (waits_of_guard(self.guards[0]),)


class _Body(Branches):
    """The body of an interrupt as the only branch; cancelling it withdraws the guard of the interrupt."""

    __slots__ = ("interruption",)

    interruption: _Interruption

    def _task_for(self, body: Body) -> Task:
        """What executes the body: its optimized code checks for cancellation, even inside a process whose code does
        not.
        """
        task = super()._task_for(body)
        if isinstance(task, RoutineTask) and not isinstance(task, CheckedTask) and not isinstance(body, Awaitable):
            return CheckedTask(cast("Branch", body), self, self._parent)
        return task

    def branch_ended(self, branch: Task, error: BaseException | None) -> None:
        """See ``Join.branch_ended``. A body that ends by itself withdraws the guard, unless that has been chosen."""
        super().branch_ended(branch, error)
        if not isinstance(error, Cancelled) and self.interruption.selector.waiting is not None:
            self.interruption.end_waiting()

    def withdraw(self, party: Party) -> bool:
        """See ``Branches.withdraw``."""
        if self.pending:
            self.interruption.retract()
        return super().withdraw(party)


@coroutine
def interrupt(body: Body, guard: Guard, handler: Callable[[], Awaitable[object]]) -> Generator[None, None, None]:
    """Runs ``body``; once ``guard`` is ready, abandons the body at its next communication and runs ``handler``. See
    ``interrupted``.
    """
    policy = present().policy
    if policy is not None:
        taken = yield from _interrupted_by(policy, body, guard)
    else:
        taken = yield from interrupted(body, guard)
    if taken:
        yield from handler().__await__()


def interrupted(body: Body, guard: Guard) -> Generator[None, None, bool]:
    """Runs ``body``; once ``guard`` is ready, abandons the body at its next communication. Returns whether it did.

    The guard communicates when the body has ended. If the body ends by itself, nothing else happens. An ``Input`` guard
    keeps what it read as its ``value``.
    """
    scheduler = present()
    task = scheduler.current
    if task.cancelled:
        if iscoroutine(body):
            body.close()
        raise Cancelled
    branches = _Body(task)
    branches.start((body,))
    interruption = branches.interruption = _Interruption((guard,))
    interruption.body = branches.tasks[0]
    interruption.begin_waiting(task, 1, {}, {})
    if interruption.selector.ready or interruption.time_outs_passed(1, {}):
        interruption.wake()
    try:
        yield from branches.wait()
        scheduler.current = task
        interruption.body_has_ended = True
        while interruption.pledged is not None:
            if task.cancelled and interruption.withdraw(task):
                raise Cancelled
            task.waiting = interruption
            yield
            scheduler.current = task
    finally:
        interruption.retract()
        interruption.give_up()
    if interruption.chosen >= 0:
        value = interruption.value
    elif interruption.woken and branches.cancelled:
        value = yield from _communication(guard)
    else:
        return False  # The body ended before its next communication.
    if isinstance(guard, Input):
        guard.value = value
    return True


class _Led:
    """An interrupt whose body is running; a policy decides when it happens."""

    def __init__(self, task: Task, option: Option, body: Task) -> None:
        self.task = task
        self.option = option
        self._body = body
        self.came = False
        self.taken = False

    def come(self, *, taken: bool) -> None:
        """See ``policy.Interruption.come``."""
        self.came, self.taken = True, taken
        self._body.cancel()


def _interrupted_by(policy: Policy, body: Body, guard: Guard) -> Generator[None, None, bool]:
    """Like ``interrupted``, in a run that a policy leads."""
    task, option = present().current, option_of(guard, 0, {}, {})
    if not policy.leads_interrupts:
        taken = yield from interrupted(body, guard)
        if taken:
            policy.did(task, option)
        return taken
    if task.cancelled:
        raise Cancelled
    branches = Branches(task)
    branches.start((body,))
    led = _Led(task, option, branches.tasks[0])
    policy.interrupt_begins(led)
    try:
        yield from branches.wait()
    finally:
        policy.interrupt_ends(led)
    if led.came and isinstance(guard, Input | Output):
        # A guard that was not taken waits for its turn like any other.
        alternative = Alternative(guard)
        yield from alternative.select_by(Policy() if led.taken else policy)
        if isinstance(guard, Input):
            guard.value = alternative.value
    if led.taken:
        policy.did(task, option)
    return led.came


def _communication(guard: Guard) -> Generator[None, None, Any]:
    """Communicates by the guard, as an alternative with this guard alone; waits if another process was faster."""
    if not isinstance(guard, Input | Output | Ready):
        if present().current.cancelled:
            raise Cancelled
        return None
    alternative = Alternative(guard)
    yield from alternative.select()
    return alternative.value
