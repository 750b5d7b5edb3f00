"""Processes that run in sequence become one: their channels, states and instances move up, their bodies stand where
they were run.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from itertools import islice

from cspdiag.base.record import replaced
from cspdiag.network.ir.actions import Action, End, Group, ParallelSteps, RunInstance
from cspdiag.network.ir.network import CreatedChoice, CreatedInstance, Network, ProcessClass, SubmodelClass
from cspdiag.network.ir.walk import instances_run, parts
from cspdiag.optimize.changes import with_inner_actions
from cspdiag.optimize.flatten.moved import EndNumbers, MovedUp
from cspdiag.optimize.reachable import reachable
from cspdiag.optimize.variables import with_assignments
from cspdiag.syntax.parse.nesting import DEEPEST

LARGEST = 20_000
"""Records that a class may have with what is taken into it; without a limit, classes that two others run, each twice,
would grow without bounds.
"""

LONGEST = 8
"""Elements of an array that are taken in; a longer one is better run by a loop."""


def flatten(network: Network) -> Network:
    """The network with each instance of a process that is run at one place, in sequence, taken into the process around
    it.

    What is run beside others stays a process, and so does what is run at several places, written by hand, or too large.
    """
    flattening = _Flattening()
    for entry in network.classes:
        flattening.add(entry)
    return reachable(replaced(network, classes=tuple(flattening.classes.values())))


class _Flattening:
    """The classes so far, each after those of its instances, with their sizes in records and the depths of their
    compositions.
    """

    def __init__(self) -> None:
        self.classes: dict[str, ProcessClass | SubmodelClass] = {}
        self._sizes: dict[str, int] = {}
        self._depths: dict[str, int] = {}

    def add(self, entry: ProcessClass | SubmodelClass) -> None:
        """Flatten one more class."""
        if isinstance(entry, ProcessClass) and entry.body is not None:
            self._sizes[entry.name] = _size(entry)
            self._depths[entry.name] = _depth(entry.body)
            if entry.instances:
                entry = self._flattened(entry, entry.body)
        self.classes[entry.name] = entry

    def _flattened(self, entry: ProcessClass, body: Action) -> ProcessClass:
        moved = self._moved(entry, body)
        if not moved:
            return entry

        def opened(action: Action) -> Action:
            if isinstance(action, RunInstance) and action.instance in moved:
                return moved[action.instance].scope(action)
            return with_inner_actions(action, opened)

        inner = moved.values()
        own = tuple(instance for instance in entry.instances if instance.name not in moved)
        flat = replaced(
            entry,
            channels=(*entry.channels, *(channel for part in inner for channel in part.channels)),
            instances=(*own, *(instance for part in inner for instance in part.instances)),
            constants=(*entry.constants, *(constant for part in inner for constant in part.constants)),
            states=(*entry.states, *(state for part in inner for state in part.states)),
            creation=tuple(creation_with(entry, moved)),
            body=opened(body),
        )
        return with_assignments(flat)

    def _moved(self, entry: ProcessClass, body: Action) -> dict[str, MovedUp]:
        """The instances to take in."""
        wanted = _run_in_sequence(body)
        if not wanted:
            return {}
        long = {name for name, count in Counter(i.array for i in entry.instances).items() if count > LONGEST}
        numbers = EndNumbers(entry)
        moved: dict[str, MovedUp] = {}
        own_depth = self._depths[entry.name]
        for instance in entry.instances:
            inner = self.classes[instance.class_name]
            if instance.name not in wanted or (instance.array is not None and instance.array in long):
                continue
            if isinstance(inner, ProcessClass) and inner.body is not None:
                part = MovedUp(instance, inner, entry, numbers, self.classes)
                size = self._sizes[entry.name] + self._sizes[inner.name] + part.size
                depth = own_depth + self._depths[inner.name] + 1
                if size <= LARGEST and depth <= DEEPEST:
                    moved[instance.name] = part
                    self._sizes[entry.name] = size
                    self._depths[entry.name] = max(self._depths[entry.name], depth)
        return moved


def _size(entry: ProcessClass) -> int:
    """Of a class that is too large already, no more is counted than tells that."""
    owned = parts((entry.body, entry.channels, entry.instances, entry.constants, entry.states))
    return sum(1 for _ in islice(owned, LARGEST + 1))


def _depth(action: Action) -> int:
    deepest = 0

    def inner(part: Action) -> Action:
        nonlocal deepest
        deepest = max(deepest, _depth(part))
        return part

    with_inner_actions(action, inner)
    return deepest + 1


def _run_in_sequence(body: Action) -> set[str]:
    """The instances that are run at one place, which is no branch of a parallel by itself."""
    places = Counter(instances_run(body))
    branches = {
        branch.instance
        for part in parts(body)
        if isinstance(part, ParallelSteps)
        for branch in map(_without_labels, part.steps)
        if isinstance(branch, RunInstance)
    }
    return {name for name, count in places.items() if count == 1} - branches


def _without_labels(action: Action) -> Action:
    while isinstance(action, Group):
        action = action.body
    return action


def creation_with(entry: ProcessClass, moved: Mapping[str, MovedUp]) -> Iterator[End | CreatedInstance | CreatedChoice]:
    """The parts of an instance that moved up are made where the instance was."""
    for part in entry.creation:
        if isinstance(part, CreatedInstance) and part.instance in moved:
            yield from moved[part.instance].creation
        else:
            yield part
