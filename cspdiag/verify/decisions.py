"""What is tried if a trace leaves something open: depth first, the last decision first."""

from __future__ import annotations

from random import Random


class Decisions:
    """The decisions of successive attempts; an attempt makes them in the order in which it reaches them."""

    def __init__(self) -> None:
        self._taken: list[int] = []
        self._options: list[int] = []
        self.made = 0
        """The number of decisions of the present attempt so far."""

    def begin(self) -> None:
        """A new attempt begins."""
        self.made = 0

    def choose(self, options: int) -> int:
        """One of ``options`` possibilities, by index."""
        if self.made == len(self._taken):
            self._taken.append(0)
            self._options.append(options)
        self.made += 1
        return self._taken[self.made - 1]

    def advance(self, cut: int | None = None) -> bool:
        """Changes the last decision that can be changed, among the first ``cut`` if given; False if all were tried."""
        end = self.made if cut is None else min(cut, self.made)
        del self._taken[end:], self._options[end:]
        while self._taken and self._taken[-1] + 1 >= self._options[-1]:
            self._taken.pop()
            self._options.pop()
        if not self._taken:
            return False
        self._taken[-1] += 1
        return True


class RandomDecisions(Decisions):
    """Random decisions, the same ones for the same number."""

    def __init__(self, number: int) -> None:
        super().__init__()
        self._random = Random(number)

    def choose(self, options: int) -> int:
        """See ``Decisions.choose``."""
        self.made += 1
        return self._random.randrange(options)
