"""What may want the processor at the same time: of the threads of a program those that run beside each other."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence

from cspdiag.analyses.timing.flow.demands import Demand, across, merged
from cspdiag.analyses.timing.threads.graph import Thread

Key = tuple[int, int, int]
"""Demands by thread, period and origin."""


class Contention:
    """The demands of threads, and of those that run beside them. Threads are numbered as ``with_forks`` of the
    outermost one lists them; ``own`` has the demands of each.
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
        self._wholes: dict[int, list[Demand]] = {}

    def everything(self) -> list[Demand]:
        """What the whole program demands at most at any time."""
        return self.below(0)

    def group_of(self, number: int) -> tuple[int, int] | None:
        """The parallel that a thread is a branch of: who starts it, and which of its parallels it is. None for the
        outermost thread.
        """
        return self._parents.get(number)

    def is_alive(self, one: int, other: int) -> bool:
        """Whether one thread runs beside another one whenever that runs, unless an exception ends both."""
        if one == other:
            return True
        if one in self._line(other):
            return False
        group = self._parents.get(one)
        return any(self._parents.get(number) == group for number in self._line(other))

    def together(self, group: tuple[int, int]) -> list[Demand]:
        """What is demanded while a parallel runs: by its branches, and beside it."""
        parent, which = group
        branches = [
            part for inner in self._threads[parent].forks[which] for part in self.below(self._numbers[id(inner)])
        ]
        return branches + self.beside(parent)

    def beside(self, number: int, without: Collection[Key] = ()) -> list[Demand]:
        """What runs in parallel with a thread. What that starts or is started by does not run at the same time."""
        apart = self._with_ancestors({thread for thread, _, _ in without})
        found: list[Demand] = []
        group = self._parents.get(number)
        while group is not None:
            parent, which = group
            for inner in self._threads[parent].forks[which]:
                other = self._numbers[id(inner)]
                if other != number:
                    found += self._demanded(other, without, apart)
            number, group = parent, self._parents.get(parent)
        return found

    def below(self, number: int) -> list[Demand]:
        """What a thread or, at other times, the threads that it starts demand."""
        return self._demanded(number, (), ())

    def _demanded(self, number: int, without: Collection[Key], apart: Collection[int]) -> list[Demand]:
        """As ``below``, without some demands; ``apart`` are the threads that these are of, and those around them."""
        if number not in apart and number in self._wholes:
            return self._wholes[number]
        own = self._own.get(number, [])
        own = [part for part in own if (part.thread, part.period, part.origin) not in without]
        groups = [merged([own])]
        for group in self._threads[number].forks:
            branches = (self._numbers[id(inner)] for inner in group)
            groups.append([part for inner in branches for part in self._demanded(inner, without, apart)])
        found = groups[0] if len(groups) == 1 else across(groups)
        if number not in apart:
            self._wholes[number] = found
        return found

    def _with_ancestors(self, numbers: Collection[int]) -> set[int]:
        return {ancestor for number in numbers for ancestor in self._line(number)}

    def _line(self, number: int) -> Iterator[int]:
        yield number
        while (group := self._parents.get(number)) is not None:
            number, _ = group
            yield number
