"""Priority levels: the ready queue of each branch of a prioritized parallel.

The language compares the ranks of nested ``||>`` from the outermost inwards. The numbers of branches at each depth of
nesting, over the whole program, give every rank a fixed distance in levels from its parent, which keeps that order.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import assert_never

from cspdiag.base.record import replaced
from cspdiag.network.elaborate.fewer.continued import continued
from cspdiag.network.ir.actions import Action, ParallelSteps, RunInstance
from cspdiag.network.ir.network import Network, ProcessClass, SubmodelClass
from cspdiag.network.ir.walk import actions_inside, all_actions


class Levels:
    """The levels of one program; level 0 is the highest."""

    def __init__(self, network: Network) -> None:
        self._classes = {entry.name: entry for entry in network.classes if isinstance(entry, ProcessClass)}
        self.prioritized = frozenset(_with_priorities(network))
        """Classes that contain prioritized parallels, themselves or in an instance."""
        self.depths: dict[str, set[int]] = {name: set() for name in self._classes}
        widths: dict[int, int] = {}
        pending = [(network.top, 0)]
        while pending:
            name, depth = pending.pop()
            if depth in self.depths[name]:
                continue
            self.depths[name].add(depth)
            entry = self._classes[name]
            if entry.body is None or name not in self.prioritized:
                continue
            inner = {instance.name: instance.class_name for instance in entry.instances}
            for step, below in _steps(entry.body, depth):
                match step:
                    case ParallelSteps(prioritized=True):
                        widths[below] = max(widths.get(below, 1), len(step.steps))
                    case RunInstance() if inner[step.instance] in self._classes:
                        pending.append((inner[step.instance], below))
                    case ParallelSteps() | RunInstance():
                        pass
                    case _:
                        assert_never(step)
        self._sizes = [1]
        for depth in sorted(widths, reverse=True):
            self._sizes.insert(0, self._sizes[0] * widths[depth])

    @property
    def count(self) -> int:
        """The number of levels."""
        return self._sizes[0]

    def below(self, class_: str, depth: int, rank: int) -> int:
        """The number of levels from the parent down to a branch; ``depth`` is the number of prioritized parallels
        around it in its class.
        """
        if rank == 0:
            return 0
        outer = min(self.depths[class_], default=0)  # ``separate_depths`` has left one; none: it never runs
        return rank * self._sizes[min(outer + depth + 1, len(self._sizes) - 1)]


@continued
def _with_priorities(network: Network) -> tuple[str, ...]:
    """Classes that contain prioritized parallels, themselves or in an instance."""
    found: dict[str, None] = {}
    for entry in network.classes:
        if isinstance(entry, ProcessClass) and entry.body is not None:
            own = any(isinstance(step, ParallelSteps) and step.prioritized for step in all_actions(entry.body))
            if own or (found and any(instance.class_name in found for instance in entry.instances)):
                found[entry.name] = None
    return tuple(found)


def separate_depths(network: Network) -> Network:
    """The network in which all instances of a class with prioritized parallels are at one depth of nesting; for other
    depths the class is cloned, as ``Cell_at_2``.
    """
    levels = Levels(network)
    if all(len(depths) <= 1 for name, depths in levels.depths.items() if name in levels.prioritized):
        return network
    taken = {entry.name for entry in network.classes}
    names = {(name, min(depths)): name for name, depths in levels.depths.items() if depths}
    clones: dict[str, list[ProcessClass | SubmodelClass]] = {}
    for entry in network.classes:
        if not isinstance(entry, ProcessClass) or entry.name not in levels.prioritized:
            clones[entry.name] = [entry]
            continue
        clones[entry.name] = []
        for depth in sorted(levels.depths[entry.name]) or [0]:
            name = names.setdefault((entry.name, depth), _fresh(f"{entry.name}_at_{depth + 1}", taken))
            clones[entry.name].append(_at_depth(entry, name, depth, names, levels.prioritized))
    return replaced(network, classes=tuple(clone for entry in network.classes for clone in clones[entry.name]))


def _fresh(name: str, taken: set[str]) -> str:
    while name in taken:
        name += "_"
    taken.add(name)
    return name


def _at_depth(
    entry: ProcessClass, name: str, depth: int, names: dict[tuple[str, int], str], prioritized: frozenset[str]
) -> ProcessClass:
    """The clone of a class for a depth, with its instances at their depths."""
    around = {step.instance: below for step, below in _steps(entry.body, depth) if isinstance(step, RunInstance)}
    instances = tuple(
        replaced(instance, class_name=names[instance.class_name, around[instance.name]])
        if instance.class_name in prioritized and instance.name in around
        else instance
        for instance in entry.instances
    )
    return replaced(entry, name=name, instances=instances)


def _steps(action: Action | None, depth: int) -> Iterator[tuple[ParallelSteps | RunInstance, int]]:
    """The parallels and runs of instances in an action, each with the number of prioritized parallels around it."""
    pending = [] if action is None else [(action, depth)]
    while pending:
        part, around = pending.pop()
        if isinstance(part, ParallelSteps | RunInstance):
            yield part, around
        below = around + (isinstance(part, ParallelSteps) and part.prioritized)
        pending += [(inner, below) for inner in actions_inside(part)]
