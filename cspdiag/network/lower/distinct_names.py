"""Makes distinct names."""

from __future__ import annotations

from collections.abc import Callable, Iterable


class DistinctNames:
    """Keeps the names that are taken, and numbers names that are requested again.

    The last number of each name is remembered, so a thousand requests for one name take a thousand steps, not half a
    million.
    """

    def __init__(self, taken: Iterable[str] = ()) -> None:
        self.taken = set(taken)
        self._numbers: dict[str, int] = {}

    def fresh(self, wanted: str, numbered: Callable[[int], str]) -> str:
        """``wanted`` if it is free, otherwise the first free name of ``numbered(2)``, ``numbered(3)``, …; marks it as
        taken.
        """
        name, number = wanted, self._numbers.get(wanted, 1)
        if number > 1:
            name = numbered(number)
        while name in self.taken:
            number += 1
            name = numbered(number)
        self._numbers[wanted] = number
        self.taken.add(name)
        return name
