"""Which tasks never continue, in a state that a run has reached: the greatest set of tasks of which every possible
partner is in the set or has ended.

A task that waits for a delay, a sample or the environment is not in the set, and so neither is a task that it may still
communicate with, wherever it is now.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterator
from typing import Any, TypeAlias

from cspdiag.network.ir.actions import RaiseException
from cspdiag.network.ir.network import CoreNetwork, ProcessClass
from cspdiag.network.ir.walk import parts
from cspdiag.runtime.choice.guards import waits_of_guard
from cspdiag.runtime.choice.interrupt import _Body
from cspdiag.runtime.composition import Branches
from cspdiag.runtime.deadlock.tasks import channel_identity, channels_used_by
from cspdiag.runtime.kernel.scheduler import Task
from cspdiag.verify.runs.reachable import reachable_channels
from cspdiag.verify.runs.task_names import path_of

NEVER = frozenset({"forever, at stop", "for an alternative of which no guard is enabled"})
"""What is waited for in vain, whatever other tasks do."""

Wait: TypeAlias = tuple[str, Any]
"""``to read`` or ``to write`` and the end of a channel, or other words and None."""


class Partners:
    """Which processes may take part in which communication, by the channels of a program."""

    def __init__(self, network: CoreNetwork) -> None:
        self._writers = {net.path: tuple(path for path, _ in net.writers) for net in network.nets}
        self._readers = {net.path: tuple(path for path, _ in net.readers) for net in network.nets}
        by_hand = {entry.name for entry in network.classes if isinstance(entry, ProcessClass) and entry.body is None}
        self._by_hand = {instance.path for instance in network.instances if instance.class_name in by_hand}
        self._by_hand |= {network.top} if network.top in by_hand else set()
        raising = {
            entry.name
            for entry in network.classes
            if isinstance(entry, ProcessClass)
            and (entry.body is None or any(isinstance(part, RaiseException) for part in parts(entry.body)))
        }
        self._raising = [network.top] * (network.top in raising)
        self._raising += [instance.path for instance in network.instances if instance.class_name in raising]

    def stuck(self, root: Task, outside: Collection[str]) -> list[Task]:
        """The tasks below ``root`` that never continue and do not wait for branches of their own; ``outside`` are the
        channels of the environment.
        """
        leaves, parents = _tasks(root)
        waits = {task: list(waits_of(task)) for task in leaves}
        found = {task for task in leaves if not any(_can_end_by_itself(wait, outside) for wait in waits[task])}
        uses: dict[Task, set[int]] = {}
        while True:
            waiting_parents = {parent for parent, branches in parents.items() if not found.isdisjoint(branches)}
            live = [task for task in (*leaves, *parents) if task not in found and task not in waiting_parents]
            freed = {
                task
                for task in found
                if any(self._can_be_reached(task, wait, live, uses) for wait in waits[task])
                or self._may_be_cancelled(task, found | waiting_parents)
            }
            if not freed:
                return [task for task in leaves if task in found]
            found -= freed

    def _channels_of(self, task: Task) -> set[int]:
        """The channels that a task may still use, as far as known: for code written by hand, all that it can reach."""
        return channels_used_by(task) if path_of(task) in self._by_hand else reachable_channels(task)

    def _can_be_reached(self, task: Task, wait: Wait, live: list[Task], uses: dict[Task, set[int]]) -> bool:
        """Whether a task that continues may reach what a task waits for; ``uses`` keeps what it takes long to find."""
        words, end = wait
        if end is None:
            return False
        others = (self._readers if words == "to write" else self._writers).get(end.name)
        identity = channel_identity(end)
        for other in live:
            if other is task or (others is not None and not _is_one_of(path_of(other), others)):
                continue
            if other not in uses:
                uses[other] = self._channels_of(other)
            if identity in uses[other]:
                return True
        return False

    def _may_be_cancelled(self, task: Task, stuck: set[Task]) -> bool:
        """Whether a branch in parallel with a task, or with one around it, continues and may raise an exception."""
        inside, join = task, task.join
        while isinstance(join, Branches):
            for branch in join.tasks:
                if branch is not inside and not branch.ended and branch not in stuck and self._may_raise(branch):
                    return True
            inside = join._parent
            join = inside.join
        return False

    def _may_raise(self, task: Task) -> bool:
        path = path_of(task)
        return any(raising == path or raising.startswith(f"{path}.") for raising in self._raising)


def waits_of(task: Task) -> Iterator[Wait]:
    """What a task waits for, and the guards of the interrupts around it."""
    yield from task.waits()
    join = task.join
    while isinstance(join, Branches):
        if isinstance(join, _Body):
            yield waits_of_guard(join.interruption.guards[0])
        join = join._parent.join


def _tasks(root: Task) -> tuple[list[Task], dict[Task, set[Task]]]:
    """The tasks that do not wait for branches of their own and, for each of the others, all tasks below it."""
    leaves: list[Task] = []
    parents: defaultdict[Task, set[Task]] = defaultdict(set)
    pending: list[tuple[Task, tuple[Task, ...]]] = [(root, ())]
    while pending:
        task, above = pending.pop()
        for parent in above:
            parents[parent].add(task)
        if isinstance(task.waiting, Branches) and task.waiting.pending:
            pending += [(branch, (*above, task)) for branch in reversed(task.waiting.tasks) if not branch.ended]
        else:
            leaves.append(task)
    return leaves, dict(parents)


def _can_end_by_itself(wait: Wait, outside: Collection[str]) -> bool:
    words, end = wait
    return end.name in outside if end is not None else words not in NEVER


def _is_one_of(path: str, others: tuple[str, ...]) -> bool:
    return any(other == path or other.startswith(f"{path}.") for other in others)
