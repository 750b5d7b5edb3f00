"""The alternative: waits until a guard is ready, and chooses.

It chooses at once if a guard is ready. Otherwise it waits, is readied by the first guard that becomes ready, and
chooses when it runs, among the guards that are ready then; if none is ready any longer, it waits again.
"""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from types import coroutine
from typing import Any

from ..kernel.exceptions import Cancelled
from ..kernel.party import Party, Waits
from ..kernel.policy import Policy
from ..kernel.scheduler import Task, hold, present
from .guards import Choice, Guard, option_of, waits_of_guard

_NOTHING: Mapping[int, Any] = {}


class Alternative(Choice):
    """Chooses among guards; made once, selected often.

    ``prioritized`` takes the first ready guard in text order. Otherwise the choice is fair: the first ready guard after
    the one that was chosen last, wrapping around at the end.
    """

    def __init__(self, *guards: Guard, prioritized: bool = False) -> None:
        super().__init__(guards)
        self._prioritized = prioritized
        self._all = (1 << len(guards)) - 1
        self.after_last = -1
        """The bits of the guards after the one chosen last."""
        self.after = 0
        """For optimized code: the number of the guard after the one chosen last."""

    @coroutine
    def select(
        self,
        enabled: Sequence[bool] | None = None,
        *,
        values: Mapping[int, Any] = _NOTHING,
        delays: Mapping[int, int] = _NOTHING,
    ) -> Generator[None, None, int]:
        """Waits for a guard and communicates by it; returns its index.

        ``enabled`` has a pre-condition for every guard. ``values`` are what output guards write and ``delays`` the
        durations of time-outs, by index of the guard, where they differ from the guard's own.
        """
        scheduler = present()
        if scheduler.policy is not None:
            return (yield from self.select_by(scheduler.policy, enabled, values, delays))
        if scheduler.current.cancelled:
            raise Cancelled
        mask = self._all if enabled is None else sum([1 << index for index, holds in enumerate(enabled) if holds])
        ready = self.selector.ready & mask
        if self.after_guards:
            ready |= self.time_outs_passed(mask, delays)
        if not ready:
            ready = yield from self.wait(mask, values, delays)
            if not ready:
                return self.chosen
        if self._prioritized:
            bit = ready & -ready
        else:
            bit = ready & self.after_last or ready
            bit &= -bit
            self.after_last = -bit << 1
        index = bit.bit_length() - 1
        if not self.communicate(index, values):
            yield
        return index

    def select_by(
        self,
        policy: Policy,
        enabled: Sequence[bool] | None = None,
        values: Mapping[int, Any] = _NOTHING,
        delays: Mapping[int, int] = _NOTHING,
    ) -> Generator[None, None, int]:
        """Like ``select``, in a run in which a policy decides when it continues, and with which guard."""
        options = {
            index: option_of(guard, index, values, delays)
            for index, guard in enumerate(self.guards)
            if enabled is None or enabled[index]
        }
        wanted = yield from hold(policy, *options.values())
        if wanted is not None:
            options, delays = {wanted.index: options[wanted.index]}, {**delays, wanted.index: 0}
        task = present().current
        policy.arrives(task)
        mask = sum([1 << index for index in options])
        ready = self.selector.ready & mask | self.time_outs_passed(mask, delays)
        if not ready:
            ready = yield from self.wait(mask, values, delays)
            if not ready:
                policy.did(task, options[self.chosen])
                return self.chosen
        found = [option for index, option in options.items() if ready >> index & 1]
        if not self._prioritized:
            found.sort(key=lambda option: not self.after_last >> option.index & 1)
        index = found[policy.choose(task, found, prioritized=self._prioritized)].index
        self.after_last = -1 << (index + 1)
        if not self.communicate(index, values):
            yield
        policy.did(task, options[index])
        return index

    def wait(
        self, mask: int, values: Mapping[int, Any] = _NOTHING, delays: Mapping[int, int] = _NOTHING
    ) -> Generator[None, None, int]:
        """Waits while none of the guards of ``mask`` is ready. The guards that are ready then, or 0 if the other side
        has chosen.
        """
        scheduler = present()
        task = scheduler.current
        selector = self.selector
        if self.after_guards or selector.attend & mask:
            self.begin_waiting(task, mask, values, delays)
        else:
            self.begin_waiting_alone(task, mask, values)
        task.waiting = self
        while True:
            self.woken = False
            yield
            scheduler.current = task
            self.woken = False
            if self.chosen >= 0 or self.pledged is not None or task.cancelled:
                break
            ready = selector.ready & mask
            if ready:
                self.end_waiting()
                return ready
            selector.armed = mask
        while self.pledged is not None:
            yield
            scheduler.current = task
        if self.chosen < 0:
            raise Cancelled
        self.after_last = -1 << (self.chosen + 1)
        return 0

    def park(self, me: Task, mask: int) -> None:
        """From now on the first guard of ``mask`` that becomes ready readies ``me``, a task with optimized code. None
        of the guards is a time-out.
        """
        self.task = me
        self.mask = mask
        self.chosen = -1
        self.woken = False
        selector = self.selector
        selector.waiting = self
        selector.armed = mask
        me.waiting = self

    def withdraw(self, party: Party) -> bool:
        """See ``Waiting.withdraw``. False also if the task is ready: it then notices the cancellation itself."""
        if self.pledged is not None:
            if not self.pledged.end.withdraw(self.pledged):
                return False
            self.pledged = None
            self.chosen = -1
        elif self.selector.waiting is None:
            return False
        else:
            self.end_waiting()
        return not self.woken

    def waits_for(self, party: Party) -> Waits:
        """See ``Waiting.waits_for``."""
        enabled = [guard for index, guard in enumerate(self.guards) if self.mask >> index & 1]
        if not enabled:
            return (("for an alternative of which no guard is enabled", None),)
        return tuple([waits_of_guard(guard) for guard in enabled])
