"""Runs that the caller leads, step by step, with a policy."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from ..composition import end_all, task_for
from ..kernel.party import Party
from ..kernel.policy import Policy
from ..kernel.scheduler import Priority, Scheduler, Task
from ..network import Network

Observe = Callable[[str, Any, Party | None, Party | None], None]


class StepwiseRun:
    """A run of a network in which processes continue and time passes only on request, and only what is brought to the
    ports arrives from outside. ``root`` executes the outermost process; ``error`` is what that has ended with.
    """

    def __init__(self, network: Network, policy: Policy, observe: Observe) -> None:
        self._scheduler = Scheduler(policy)
        self._scheduler.observe = observe
        self.error: BaseException | None = None
        with self._scheduler:
            self.root = task_for(network.process, self, None)
        self.ready(self.root)

    def branch_ended(self, branch: Task, error: BaseException | None) -> None:
        """The outermost process has ended."""
        self.error = error

    @property
    def now(self) -> int:
        """The present instant in nanoseconds."""
        return self._scheduler.now

    @now.setter
    def now(self, instant: int) -> None:
        self._scheduler.now = instant

    @property
    def current(self) -> Task | None:
        """The task that runs."""
        return self._scheduler.current

    @property
    def has_ready(self) -> bool:
        """Whether a party is ready on the highest level."""
        return bool(self._scheduler.queue)

    @property
    def has_levels(self) -> bool:
        """Whether there is, or was, a prioritized parallel."""
        return self._scheduler.has_levels

    def next_timer(self) -> int | None:
        """The instant at which the next delay or time-out ends."""
        return self._scheduler.timers.next_instant()

    def instants_of_timers(self) -> Iterator[int]:
        """The instant at which each delay or time-out ends."""
        return self._scheduler.timers.instants()

    def timers_fall_due(self) -> None:
        """Ends the delays and time-outs that are due now."""
        self._scheduler.timers.fall_due(self._scheduler.now)

    def ready(self, party: Party) -> None:
        """Readies a party that has halted."""
        party.ready_queue.append(party.entry)

    def run_ready(self, most: int) -> bool:
        """Runs up to ``most`` ready parties, first come, first served; False if none is left."""
        with self._scheduler as scheduler:
            return scheduler.run_ready(most)

    def take_ready(self) -> Iterator[tuple[Priority, Party]]:
        """Takes all that are ready, each with its level of priority, for ``run_one``."""
        return self._scheduler.take_ready()

    def run_one(self, party: Party) -> None:
        """Runs a party until it has to wait."""
        with self._scheduler as scheduler:
            scheduler.run_one(party)

    def close(self) -> None:
        """Ends what is still running."""
        with self._scheduler as scheduler:
            scheduler.end()
            end_all(self.root)
