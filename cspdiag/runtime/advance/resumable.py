"""A run in virtual time that its caller continues piece by piece, in one thread: up to an instant, or until it wants a
pause. In the end all that happens is the same as in ``Network.run``.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

from ..deadlock.tasks import leaves, place_of_wait, words_of
from ..kernel.clock import Clock, VirtualClock
from ..kernel.observer import Observer
from ..kernel.scheduler import Task
from ..network import Network
from ..outcome import Outcome
from ..outside.instants import Environment
from .virtual_time import Ending, Paused

_FEW = 512
"""How many ready parties run between two questions whether to pause."""


class ResumableRun:
    """One run of a network. Opens its drivers, and begins at time 0; ``outcome`` is how it has ended, if it has.

    Errors of the drivers and of the environment at time 0 are such an outcome, too.
    """

    def __init__(
        self,
        network: Network,
        environment: Environment | None = None,
        *,
        on_miss: Literal["timeout", "count"] = "timeout",
        observer: Observer | None = None,
        clock: Clock | None = None,
        until: int | None = None,
    ) -> None:
        self._scheduler = network.new_scheduler(None)
        self.outcome: Outcome | None = None
        with self._scheduler as scheduler:
            self._run = network.new_run(scheduler, environment, clock or VirtualClock(), until, on_miss, observer)
            failed = self._run.caught(self._run.start)
        if failed is not None:
            self._end(failed)

    @property
    def now(self) -> int:
        """The present instant in nanoseconds."""
        return self._scheduler.now

    @property
    def next_instant(self) -> int | None:
        """The next instant at which something may happen, besides what is left to do at the present one."""
        return self._run.virtual_time.next_instant()

    def advance(self, until: int, wants_pause: Callable[[], bool] | None = None) -> bool:
        """Continues up to ``until``; False if ``wants_pause``, which is asked now and then, has ended that before. A
        run that has ended does not continue.
        """
        return self._advance(until, self._asking(wants_pause, _FEW))

    def step(self, until: int, wants_pause: Callable[[], bool]) -> bool:
        """The same, but asks after each step of a process."""
        return self._advance(until, self._asking(wants_pause, 1))

    def _asking(self, wants_pause: Callable[[], bool] | None, most: int) -> Callable[[], bool]:
        scheduler = self._scheduler

        def run() -> bool:
            if wants_pause is not None and wants_pause():
                raise Paused
            return scheduler.run_first() if most == 1 else scheduler.run_ready(most)

        return run

    def _advance(self, until: int, run_ready: Callable[[], bool]) -> bool:
        if self.outcome is not None:
            return True
        virtual_time = self._run.virtual_time

        def part() -> Ending:
            return virtual_time.advance(until, run_ready, step_by_step=True)

        with self._scheduler:
            try:
                ending = self._run.caught(part)
            except Paused:
                return False
            if ending == "time limit":
                return True
            if not isinstance(ending, Outcome):
                ending = self._run.ended(ending, until)
        self._end(ending)
        return True

    def waiting(self, most: int) -> list[tuple[str, str, tuple[str, ...], str | None]]:
        """The processes that wait, in text order, at most ``most``: path, for what, channels, file and line."""
        if self.outcome is not None:
            return []
        found: list[tuple[str, str, tuple[str, ...], str | None]] = []
        for task in leaves(self._run.root):
            if len(found) == most:
                break
            waits = () if self._scheduler.is_ready(task) else task.waits()
            if waits:
                channels = tuple(end.name for _, end in waits if end is not None)
                found.append((_path(task), words_of(waits), channels, place_of_wait(task)))
        return found

    def end(self, at: int = 0) -> Outcome:
        """Ends the run, and releases the outputs, unless it has ended already: at the present instant, or at a later
        one up to which time has passed.
        """
        if self.outcome is None:
            self._scheduler.now = max(self._scheduler.now, at)
            self._end(Outcome("stopped", self.now))
        assert self.outcome is not None
        return self.outcome

    def end_at(self, until: int) -> Outcome:
        """The same at a time limit."""
        if self.outcome is None:
            self._end(self._run.ended("time limit", until))
        return self.end()

    def _end(self, outcome: Outcome) -> None:
        with self._scheduler:
            self.outcome = self._run.released(outcome)


def _path(task: Task) -> str:
    return "" if task.process is None else task.process.name
