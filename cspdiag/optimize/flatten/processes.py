"""Inlines processes that run in sequence: their channels, states and instances move up, their bodies replace
the run.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from itertools import islice

from cspdiag.base.record import replaced
from cspdiag.network.ir.actions import Action, End, Group, ParallelSteps, RunInstance
from cspdiag.network.ir.network import CreatedChoice, CreatedInstance, Network, ProcessClass, SubmodelClass
from cspdiag.network.ir.walk import all_actions, instances_run, parts
from cspdiag.optimize.changes import with_inner_actions
from cspdiag.optimize.flatten.inlined import EndNumbers, InlinedProcess
from cspdiag.optimize.reachable import reachable
from cspdiag.optimize.variables import with_assignments
from cspdiag.syntax.parse.nesting import MAX_DEPTH

LARGEST = 20_000
"""The largest number of records of a class with inlined instances; without a limit, classes that two others run, each
twice, would grow without bounds.
"""

LONGEST = 8
"""Arrays with up to this number of elements are inlined; longer ones are better run in a loop."""


def flatten(network: Network) -> Network:
    """The network with each instance that is run at only one place, in sequence, inlined into the process around it.

    An instance that is run in parallel with others stays a process, and so does one that is run at several places,
    written by hand, or too large.
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
        inlined = self._inlinable(entry, body)
        if not inlined:
            return entry

        def with_bodies(action: Action) -> Action:
            if isinstance(action, RunInstance) and action.instance in inlined:
                return inlined[action.instance].scope(action)
            return with_inner_actions(action, with_bodies)

        inner = inlined.values()
        own = tuple(instance for instance in entry.instances if instance.name not in inlined)
        flat = replaced(
            entry,
            channels=(*entry.channels, *(channel for part in inner for channel in part.channels)),
            instances=(*own, *(instance for part in inner for instance in part.instances)),
            constants=(*entry.constants, *(constant for part in inner for constant in part.constants)),
            states=(*entry.states, *(state for part in inner for state in part.states)),
            creation=tuple(creation_with_inlined(entry, inlined)),
            body=with_bodies(body),
        )
        return with_assignments(flat)

    def _inlinable(self, entry: ProcessClass, body: Action) -> dict[str, InlinedProcess]:
        """The instances to inline, by name."""
        candidates = _run_in_sequence(body)
        if not candidates:
            return {}
        long = {name for name, count in Counter(i.array for i in entry.instances).items() if count > LONGEST}
        numbers = EndNumbers(entry)
        inlined: dict[str, InlinedProcess] = {}
        own_depth = self._depths[entry.name]
        for instance in entry.instances:
            inner = self.classes[instance.class_name]
            if instance.name not in candidates or (instance.array is not None and instance.array in long):
                continue
            if isinstance(inner, ProcessClass) and inner.body is not None:
                part = InlinedProcess(instance, inner, entry, numbers, self.classes)
                size = self._sizes[entry.name] + self._sizes[inner.name] + part.size
                depth = own_depth + self._depths[inner.name] + 1
                if size <= LARGEST and depth <= MAX_DEPTH:
                    inlined[instance.name] = part
                    self._sizes[entry.name] = size
                    self._depths[entry.name] = max(self._depths[entry.name], depth)
        return inlined


def _size(entry: ProcessClass) -> int:
    """The number of records of a class, counted only until it is too large."""
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
    """The instances that are run at only one place, unless that is a branch of a parallel by itself."""
    places = Counter(instances_run(body))
    branches = {
        branch.instance
        for part in all_actions(body)
        if isinstance(part, ParallelSteps)
        for branch in map(_without_labels, part.steps)
        if isinstance(branch, RunInstance)
    }
    return {name for name, count in places.items() if count == 1} - branches


def _without_labels(action: Action) -> Action:
    while isinstance(action, Group):
        action = action.body
    return action


def creation_with_inlined(
    entry: ProcessClass, inlined: Mapping[str, InlinedProcess]
) -> Iterator[End | CreatedInstance | CreatedChoice]:
    """The order of creation with the parts of each inlined instance in place of the instance."""
    for part in entry.creation:
        if isinstance(part, CreatedInstance) and part.instance in inlined:
            yield from inlined[part.instance].creation
        else:
            yield part
