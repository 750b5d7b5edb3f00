"""What is tried where a trace leaves something open: depth first, the last decision first."""

from __future__ import annotations


class Decisions:
    """The decisions of one attempt after the other; an attempt asks for them in the order in which it comes to them."""

    def __init__(self) -> None:
        self._taken: list[int] = []
        self._options: list[int] = []
        self._next = 0

    def begin(self) -> None:
        """A new attempt begins."""
        self._next = 0

    def choose(self, options: int) -> int:
        """One of ``options`` possibilities, by index."""
        if self._next == len(self._taken):
            self._taken.append(0)
            self._options.append(options)
        self._next += 1
        return self._taken[self._next - 1]

    def advance(self) -> bool:
        """Change the last decision that can be changed; False if all were tried."""
        del self._taken[self._next :], self._options[self._next :]
        while self._taken and self._taken[-1] + 1 >= self._options[-1]:
            self._taken.pop()
            self._options.pop()
        if not self._taken:
            return False
        self._taken[-1] += 1
        return True
