"""Contention for the processor: what the threads that run in parallel may demand at the same time."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence

from cspdiag.analyses.timing.flow.demands import Demand, largest_of_groups, merged
from cspdiag.analyses.timing.threads.graph import Thread

DemandKey = tuple[int, int, int]
"""What identifies a demand: its thread, period and origin."""


class Contention:
    """The demands of threads, and of those that run in parallel with them.

    Threads are numbered in the order of ``with_forks`` of the outermost one; ``own`` gives the demands of each.
    """

    def __init__(self, threads: Sequence[Thread], own: Mapping[int, list[Demand]]) -> None:
        self._threads = threads
        self._own = own
        self._numbers = {id(thread): k for k, thread in enumerate(threads)}
        self._parents = {
            self._numbers[id(inner)]: (parent, which)
            for parent, thread in enumerate(threads)
            for which, group in enumerate(thread.forks)
            for inner in group
        }
        self._subtrees: dict[int, list[Demand]] = {}

    def of_program(self) -> list[Demand]:
        """What the program demands at most at any time."""
        return self.of_subtree(0)

    def group_of(self, number: int) -> tuple[int, int] | None:
        """The parallel composition that a thread is a branch of: the thread that starts it, and the number of the
        composition in that thread. None for the outermost thread.
        """
        return self._parents.get(number)

    def may_be_abandoned(self, number: int) -> bool:
        """Whether something outside a thread may end it: an interrupt or a handler around the branches that it is one
        of.
        """
        while (group := self._parents.get(number)) is not None:
            number, which = group
            parent = self._threads[number]
            if len(parent.places[parent.joins[which]].offers) > 1:
                return True
        return False

    def runs_whenever(self, one: int, other: int) -> bool:
        """Whether ``one`` runs whenever ``other`` runs, unless an exception ends both."""
        if one == other:
            return True
        if one in self._ancestry(other):
            return False
        group = self._parents.get(one)
        return any(self._parents.get(number) == group for number in self._ancestry(other))

    def of_group(self, group: tuple[int, int]) -> list[Demand]:
        """What is demanded while a parallel composition runs: by its branches and by what runs in parallel with it."""
        parent, which = group
        branches = [
            part for inner in self._threads[parent].forks[which] for part in self.of_subtree(self._numbers[id(inner)])
        ]
        return branches + self.in_parallel_with(parent)

    def in_parallel_with(self, number: int, without: Collection[DemandKey] = ()) -> list[Demand]:
        """What is demanded in parallel with a thread, without the threads that it starts and those that started it."""
        affected = self._with_ancestors({thread for thread, _, _ in without})
        found: list[Demand] = []
        group = self._parents.get(number)
        while group is not None:
            parent, which = group
            for inner in self._threads[parent].forks[which]:
                other = self._numbers[id(inner)]
                if other != number:
                    found += self._demanded(other, without, affected)
            number, group = parent, self._parents.get(parent)
        return found

    def of_subtree(self, number: int) -> list[Demand]:
        """What a thread demands, or at other times the threads that it starts."""
        return self._demanded(number, (), ())

    def _demanded(self, number: int, without: Collection[DemandKey], affected: Collection[int]) -> list[Demand]:
        """As ``of_subtree``, without some demands; ``affected`` are the threads of these demands and their
        ancestors.
        """
        if number not in affected and number in self._subtrees:
            return self._subtrees[number]
        own = self._own.get(number, [])
        own = [part for part in own if (part.thread, part.period, part.origin) not in without]
        groups = [merged([own])]
        for group in self._threads[number].forks:
            branches = (self._numbers[id(inner)] for inner in group)
            groups.append([part for inner in branches for part in self._demanded(inner, without, affected)])
        found = groups[0] if len(groups) == 1 else largest_of_groups(groups)
        if number not in affected:
            self._subtrees[number] = found
        return found

    def _with_ancestors(self, numbers: Collection[int]) -> set[int]:
        return {ancestor for number in numbers for ancestor in self._ancestry(number)}

    def _ancestry(self, number: int) -> Iterator[int]:
        yield number
        while (group := self._parents.get(number)) is not None:
            number, _ = group
            yield number
