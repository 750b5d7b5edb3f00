"""Whether a run has reached what was refuted."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TypeAlias

from cspdiag.base.record import record
from cspdiag.runtime.composition import Branches
from cspdiag.runtime.deadlock.tasks import place_of_wait
from cspdiag.runtime.kernel.scheduler import Task
from cspdiag.verify.guided.script import Actor, Happened, Standing
from cspdiag.verify.runs.names import belongs
from cspdiag.verify.runs.recurrence import Recurrence
from cspdiag.verify.runs.stuck import Partners, waits_of
from cspdiag.verify.runs.task_names import TaskNames, path_of
from cspdiag.verify.runs.trace import Trace

STANDSTILLS = frozenset({"deadlock", "knot"})

Offer: TypeAlias = tuple[str, str]
"""What a waiting process could continue with: ``to read`` or ``to write`` and a channel, or other words and ""."""

_PART = ": "
"""Occurs in the names of events without a channel: the end of a parallel, a delay."""


@record
class Goal:
    """What a run has to reach; ``outside`` are the channels of the environment, ``visible`` those that a specification
    sees.

    ``cycle``: from this entry of the script on everything is repeated, after ``period`` entries. ``ends``: everything
    has to end without any further visible event. ``further``: a specification may see more than the trace has; whether
    it allows that is checked afterwards.
    """

    trace: Trace
    outside: frozenset[str]
    visible: frozenset[str]
    cycle: int
    period: int
    ends: bool
    partners: Partners
    recurrence: Recurrence
    further: bool = False

    @property
    def is_standstill(self) -> bool:
        """Whether some or all processes have to wait forever."""
        return self.trace.failure in STANDSTILLS

    def expected(self) -> tuple[str, ...]:
        """For a refinement, the channels that the specification sees, in order."""
        steps = (step for step in self.trace.steps if step.kind in {"external", "sample"})
        return tuple(step.channel for step in steps if step.channel in self.visible)

    def shows_round(self, happened: Sequence[Happened]) -> bool:
        """Whether a round of what is repeated can be shown: it has entries, and those of a livelock are invisible."""
        channels = {entry.channel for entry in happened}
        return bool(channels) and not (self.trace.failure == "livelock" and channels & self.outside)

    def missed(self, root: Task, names: TaskNames) -> str | None:
        """Why no process is stuck forever although none is ready; None if some or all are."""
        waiting = [
            task
            for task in _leaves(root)
            if self.trace.failure == "deadlock" or self._is_stuck(path_of(task), list(_offers(task)))
        ]
        if not waiting:
            return "no process is stuck"
        stuck = self.stuck(root)
        for task in waiting:
            if task not in stuck:
                channel = next((channel for _, channel in _offers(task) if channel), "")
                return f"`{self.called(task, names)}` can still continue" + (f" with `{channel}`" if channel else "")
        return None

    def stuck(self, root: Task) -> list[Task]:
        """The tasks that never continue."""
        return self.partners.stuck(root, self.outside)

    def has_expected_waits(self, root: Task) -> bool:
        """Whether the tasks that wait are those of the counterexample, and for the same channels."""
        waiting = [(path_of(task), {channel for _, channel in _offers(task) if channel}) for task in _leaves(root)]
        expected = [(of, {channel.partition(" (")[0] for channel in channels}) for of, channels in self.trace.stuck]
        all_are_expected = self.trace.failure != "deadlock" or all(
            any(belongs(path, of) and (waits & channels or not waits) for of, channels in expected)
            for path, waits in waiting
        )
        return all_are_expected and all(
            any(belongs(path, of) and waits & channels for path, waits in waiting)
            for of, channels in expected
            if any(_PART not in channel for channel in channels)
        )

    def called(self, task: Task, names: TaskNames) -> str:
        """The name of a task in the counterexample; one that does not occur in it has the name that it would have
        there.
        """
        own = names.called(task)
        path, waits = path_of(task), {channel for _, channel in _offers(task) if channel}
        fitting = [
            name
            for name, (of, channels) in zip(self.trace.stuck_names, self.trace.stuck, strict=False)
            if belongs(path, of) and waits & channels
        ]
        if own in fitting:
            return own
        others = [name for name in fitting if not name.rpartition(".")[2].isdecimal()]
        return min(others, key=lambda name: not name.startswith(f"{own} ("), default=own)

    def standing(self, root: Task, names: TaskNames) -> Iterator[Standing]:
        """The tasks that wait forever."""
        for task in _leaves(root):
            offers = list(_offers(task))
            if self.trace.failure == "deadlock" or self._is_stuck(path_of(task), offers):
                actor = Actor(path_of(task), names.possible_names(task), place_of_wait(task))
                yield Standing(actor, frozenset(channel for _, channel in offers if channel))

    def _is_stuck(self, path: str, offers: Iterable[Offer]) -> bool:
        channels = {channel for _, channel in offers if channel}
        return any(belongs(path, of) and channels & waits for of, waits in self.trace.stuck)


def _leaves(root: Task) -> Iterator[Task]:
    """The tasks that do not wait for branches of their own."""
    pending = [root]
    while pending:
        task = pending.pop()
        if isinstance(task.waiting, Branches) and task.waiting.pending:
            pending += [branch for branch in task.waiting.tasks if not branch.ended]
        else:
            yield task


def _offers(task: Task) -> Iterator[Offer]:
    """What a task waits for, and the guards of the interrupts around it."""
    for words, end in waits_of(task):
        yield words, "" if end is None else end.name
