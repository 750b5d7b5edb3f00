"""Levels of priority: which queue the branches of prioritized parallels stand in.

The language compares the ranks of nested ``||>`` from the outermost inwards. Counting the branches at each depth of the whole program
gives every rank a fixed distance in levels from the parent's, in that order.
"""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.network.actions import Action, ParallelSteps, RunInstance
from cspdiag.network.ir import Network, ProcessClass
from cspdiag.network.walk import parts


class Levels:
    """The levels of one program; level 0 is the highest."""

    def __init__(self, network: Network) -> None:
        self._classes = {entry.name: entry for entry in network.classes if isinstance(entry, ProcessClass)}
        self._prioritized = self._with_priorities(network)
        self.depths: dict[str, set[int]] = {name: set() for name in self._classes}
        widths: dict[int, int] = {}
        pending = [(network.top, 0)]
        while pending:
            name, depth = pending.pop()
            if depth in self.depths[name]:
                continue
            self.depths[name].add(depth)
            entry = self._classes[name]
            if entry.body is None or name not in self._prioritized:
                continue
            inner = {instance.name: instance.class_name for instance in entry.instances}
            for step, below in _steps(entry.body, depth):
                if isinstance(step, ParallelSteps) and step.prioritized:
                    widths[below] = max(widths.get(below, 1), len(step.steps))
                elif isinstance(step, RunInstance) and inner[step.instance] in self._classes:
                    pending.append((inner[step.instance], below))
        self._sizes = [1]
        for depth in sorted(widths, reverse=True):
            self._sizes.insert(0, self._sizes[0] * widths[depth])

    @property
    def count(self) -> int:
        """How many there are."""
        return self._sizes[0]

    def below(self, class_: str, depth: int, rank: int) -> int:
        """By how many levels a branch is below its parent; ``depth`` counts the prioritized parallels around it in the class."""
        if rank == 0:
            return 0
        outer = min(self.depths[class_])
        return rank * self._sizes[outer + depth + 1]

    def _with_priorities(self, network: Network) -> set[str]:
        """Classes with prioritized parallels in them or in an instance inside."""
        found: set[str] = set()
        for entry in network.classes:
            if isinstance(entry, ProcessClass) and entry.body is not None:
                own = any(isinstance(part, ParallelSteps) and part.prioritized for part in parts(entry.body))
                if own or any(instance.class_name in found for instance in entry.instances):
                    found.add(entry.name)
        return found


def _steps(action: Action, depth: int) -> Iterator[tuple[Action, int]]:
    """The parallels and runs of instances in an action, with the number of prioritized parallels around each."""
    pending: list[tuple[object, int]] = [(action, depth)]
    while pending:
        part, around = pending.pop()
        if isinstance(part, ParallelSteps | RunInstance):
            yield part, around
        if isinstance(part, ParallelSteps) and part.prioritized:
            pending += [(step, around + 1) for step in part.steps]
        else:
            pending += [(inner, around) for inner in _inner(part)]


def _inner(part: object) -> Iterator[object]:
    from cspdiag.diagnostics.record import field_names, is_record

    if isinstance(part, tuple):
        yield from part
    elif is_record(part):
        yield from (getattr(part, name) for name in field_names(part) if name not in ("span", "type"))
