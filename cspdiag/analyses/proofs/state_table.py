"""The set of packed states seen so far, in the order in which they were found: a hash table that takes whole batches at once.

Open addressing with linear probing (Knuth, "The Art of Computer Programming", volume 3, section 6.4). The table holds numbers of states plus one,
0 being free; the states themselves are kept once, in the order of their numbers. Of equal states in a batch one wins the free place, the others find
it in the next round.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from cspdiag.analyses.proofs.packing import Flags, Indices, Words
from cspdiag.analyses.proofs.verdict import Limits

_MULTIPLIERS = (0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9, 0x27D4EB2F165667C5)
_SMALLEST = 1 << 12
_FILLED_AT_ONCE = 1 << 18


class StateTable:
    """States by number, and numbers by state. ``words`` is the number of words of a state; what would take more memory than allowed raises LimitError."""

    def __init__(self, words: int, limits: Limits) -> None:
        self.count = 0
        self._limits = limits
        self._store = [np.zeros(_SMALLEST, np.int64) for _ in range(words)]
        self._table = np.zeros(2 * _SMALLEST, np.int32)

    @property
    def bytes(self) -> int:
        """The memory that the table takes."""
        return self._table.nbytes + sum(word.nbytes for word in self._store)

    def states(self, first: int, last: int) -> Words:
        """The states with numbers from ``first`` to before ``last``: views, valid until more are added."""
        return [word[first:last] for word in self._store]

    def add(self, batch: Words) -> None:
        """Add the states of a batch that are not there; the new ones have the numbers from ``count`` on."""
        self._reserve(len(batch[0]))
        slots = self._slots(batch)
        while len(slots):
            found = self._table.take(slots)
            free = np.flatnonzero(found == 0)
            if len(free):
                won = self._claim(slots, free, batch)
                found[won] = self._table.take(slots[won])
            left = np.flatnonzero(self._differs(found, batch))
            slots, batch = slots[left], [word[left] for word in batch]
            slots += found[left] != 0
            slots &= len(self._table) - 1

    def find(self, batch: Words) -> Indices:
        """The number of each state, or -1 where it is not there."""
        result = np.full(len(batch[0]), -1, np.intp)
        slots = self._slots(batch)
        pending = np.arange(len(slots))
        while len(pending):
            found = self._table.take(slots)
            differs = self._differs(found, batch)
            there = ~differs
            result[pending[there]] = found[there] - 1
            left = np.flatnonzero(differs & (found != 0))
            slots, batch, pending = slots[left], [word[left] for word in batch], pending[left]
            slots += 1
            slots &= len(self._table) - 1
        return result

    def _claim(self, slots: Indices, free: Indices, batch: Words) -> Indices:
        """Give the free slots to states of the batch, one each, and the states their numbers. Returns which won."""
        wanted = slots[free]
        self._table[wanted] = free
        won: Indices = free[self._table.take(wanted) == free]
        first, last = self.count, self.count + len(won)
        for word, store in zip(batch, self._store, strict=True):
            store[first:last] = word.take(won)
        self._table[slots[won]] = np.arange(first + 1, last + 1)
        self.count = last
        return won

    def _differs(self, found: npt.NDArray[np.int32], batch: Words) -> Flags:
        """Where the state with the number found (less one) is not the one asked for; also where there is none."""
        differs: Flags = found == 0
        at = found - 1
        for word, store in zip(batch, self._store, strict=True):
            differs |= store.take(at) != word
        return differs

    def _slots(self, batch: Words) -> Indices:
        mixed = np.zeros(len(batch[0]), np.uint64)
        for at, word in enumerate(batch):
            mixed ^= word.view(np.uint64) * np.uint64(_MULTIPLIERS[at % len(_MULTIPLIERS)])
            mixed ^= mixed >> np.uint64(29)
            mixed *= np.uint64(_MULTIPLIERS[(at + 1) % len(_MULTIPLIERS)])
        mixed >>= np.uint64(64 - (len(self._table) - 1).bit_length())
        return mixed.view(np.int64)

    def _reserve(self, more: int) -> None:
        """Make room for so many more states, so that the table stays at most half full."""
        needed = self.count + more
        size = len(self._store[0])
        if needed > size:
            size = max(needed, size + size // 2)
            self._limits.check(self._table.nbytes + 8 * size * len(self._store) + 8 * size)
            for at, word in enumerate(self._store):
                self._store[at] = _longer(word, size)
        if 2 * needed > len(self._table):
            slots = 1 << (2 * needed - 1).bit_length()
            self._limits.check(self.bytes + 4 * slots)
            self._table = np.zeros(slots, np.int32)
            self._fill()

    def _fill(self) -> None:
        """Enter all states into an empty table."""
        for first in range(0, self.count, _FILLED_AT_ONCE):
            last = min(first + _FILLED_AT_ONCE, self.count)
            slots = self._slots(self.states(first, last))
            numbers = np.arange(first + 1, last + 1, dtype=np.int32)
            while len(slots):
                free = self._table.take(slots) == 0
                self._table[slots[free]] = numbers[free]
                left = self._table.take(slots) != numbers
                slots, numbers = slots[left] + 1, numbers[left]
                slots &= len(self._table) - 1


def _longer(word: npt.NDArray[np.int64], size: int) -> npt.NDArray[np.int64]:
    result = np.zeros(size, np.int64)
    result[: len(word)] = word
    return result
