"""When a guided run has reached the situation of an earlier iteration, so it can continue in the same way forever."""

from __future__ import annotations

from cspdiag.runtime.kernel.scheduler import Task
from cspdiag.runtime.network import Network
from cspdiag.verify.guided.goal import Goal
from cspdiag.verify.guided.world import World


class Repetition:
    """Compares the situations of a run after each round of what its goal repeats."""

    def __init__(self, goal: Goal, world: World, network: Network) -> None:
        self._goal = goal
        self._world = world
        self._process = network.process
        self._rounds = 0
        self._situations: dict[tuple[object, ...], tuple[int, int, int]] = {}
        self.found: tuple[int, int] | None = None
        """After how many rounds, and nanoseconds, everything is as it was before."""
        self.period = slice(0, 0)
        """Where these rounds are in what happened."""

    def is_due(self, done: int) -> bool:
        """Whether the first ``done`` entries of the script complete another round."""
        goal = self._goal
        if not goal.period or done < goal.cycle + self._rounds * goal.period:
            return False
        while done >= goal.cycle + self._rounds * goal.period:
            self._rounds += 1
        return True

    def look(self, root: Task, now: int, happened: int) -> bool:
        """Whether tasks, values, delays and samples are as they were after an earlier round; ``happened`` is the
        number of things that have happened.
        """
        situation = (*self._world.situation, *self._goal.recurrence.state(self._process, root))
        rounds, instant, began = self._situations.setdefault(situation, (self._rounds, now, happened))
        if rounds < self._rounds:
            self.found = self._rounds - rounds, now - instant
            self.period = slice(began, happened)
        return self.found is not None
