"""The set of packed states seen so far, in the order in which they were found: a hash table that takes whole batches at
once.

Open addressing with linear probing (Knuth, "The Art of Computer Programming", volume 3, section 6.4), at most half
full. The table holds keys; 0 is a free slot. The key of a state of one word is that word plus one; for longer states it
is a hash, and states with equal keys are compared. Of equal states in a batch one wins the free slot, the others find
it in the next round.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from cspdiag.proofs.search.packing import Flags, Indices, Words
from cspdiag.proofs.verdict import Limits

Keys = npt.NDArray[np.int64]

_MULTIPLIERS = (0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9, 0x27D4EB2F165667C5)
_SMALLEST = 1 << 12
_LARGE = 1 << 21
"""Smaller tables grow in larger steps."""
_FILLED_AT_ONCE = 1 << 18


class StateTable:
    """States by number, and numbers by state. ``words`` is the number of words of a state. Methods raise LimitError if
    they would need more memory than allowed.
    """

    def __init__(self, words: int, limits: Limits) -> None:
        self.count = 0
        self._limits = limits
        self._store = [np.zeros(_SMALLEST, np.int64) for _ in range(words)]
        self._table = np.zeros(2 * _SMALLEST, np.int64)
        self._numbers = np.zeros(0, np.int32)
        """The number of the state in each slot of the table; kept for states of several words, otherwise made when
        needed.
        """
        self._numbered = 0
        """The number of states when these numbers were made."""
        if words > 1:
            self._numbers = np.zeros(len(self._table), np.int32)

    @property
    def bytes(self) -> int:
        """The memory that the table takes."""
        return self._table.nbytes + self._numbers.nbytes + sum(word.nbytes for word in self._store)

    def states(self, first: int, last: int) -> Words:
        """The states with numbers from ``first`` to before ``last``: views, valid until more are added."""
        return [word[first:last] for word in self._store]

    def add(self, batch: Words) -> None:
        """Adds the states of a batch that are new; their numbers begin at ``count``."""
        self._reserve(len(batch[0]))
        keys = _keys(batch)
        slots = self._slots(keys)
        while len(slots):
            found = self._table.take(slots)
            differs = found != keys
            if len(batch) > 1:
                self._compare(differs, slots, batch)
            left = np.flatnonzero(differs)
            slots, keys, found, batch = slots[left], keys[left], found[left], [word[left] for word in batch]
            free = np.flatnonzero(found == 0)
            if len(free):
                self._claim(slots, keys, free, batch)
            slots += found != 0
            slots &= len(self._table) - 1

    def find(self, batch: Words) -> Indices:
        """The number of each state; -1 for states that are not in the table."""
        if len(self._store) == 1 and self._numbered != self.count:
            self._number()
        keys = _keys(batch)
        places = self._places(keys, batch)
        return np.where(self._table[places] == 0, -1, self._numbers[places])

    def _places(self, keys: Keys, batch: Words) -> Indices:
        """The slot of each state, or the slot where it would be added."""
        places = self._slots(keys)
        pending = np.arange(len(places))
        while len(pending):
            slots = places[pending]
            found = self._table.take(slots)
            differs = found != keys[pending]
            if len(batch) > 1:
                self._compare(differs, slots, [word[pending] for word in batch])
            left = np.flatnonzero(differs & (found != 0))
            pending = pending[left]
            places[pending] = (slots[left] + 1) & (len(self._table) - 1)
        return places

    def _claim(self, slots: Indices, keys: Keys, free: Indices, batch: Words) -> None:
        """Assigns the free slots to states of the batch, one each, and numbers to these states. The losers find them in
        the next round.
        """
        wanted = slots[free]
        self._table[wanted] = ~free
        won = free[self._table.take(wanted) == ~free]
        first, last = self.count, self.count + len(won)
        for word, store in zip(batch, self._store, strict=True):
            store[first:last] = word.take(won)
        places = slots[won]
        self._table[places] = keys[won]
        if len(batch) > 1:
            self._numbers[places] = np.arange(first, last)
        self.count = last

    def _compare(self, differs: Flags, slots: Indices, batch: Words) -> None:
        """Marks also the states that differ although their keys are equal."""
        same = np.flatnonzero(~differs)
        numbers = self._numbers.take(slots[same])
        for word, store in zip(batch, self._store, strict=True):
            differs[same] |= store.take(numbers) != word[same]

    def _slots(self, keys: Keys) -> Indices:
        mixed = keys.view(np.uint64) * np.uint64(_MULTIPLIERS[0])
        mixed ^= mixed >> np.uint64(32)
        mixed *= np.uint64(_MULTIPLIERS[1])
        mixed >>= np.uint64(64 - (len(self._table) - 1).bit_length())
        return mixed.view(np.int64)

    def _reserve(self, more: int) -> None:
        """Makes room for ``more`` states, so that the table stays at most half full."""
        needed = self.count + more
        size = len(self._store[0])
        if needed > size:
            size = max(needed, size + size // 2)
            self._limits.check(self._table.nbytes + self._numbers.nbytes + 8 * size * (len(self._store) + 1))
            for at, word in enumerate(self._store):
                self._store[at] = _longer(word, size)
        if 2 * needed > len(self._table):
            slots = 1 << (2 * needed - 1).bit_length()
            if slots < _LARGE:
                slots *= 4
            self._limits.check(self.bytes + (8 if len(self._store) == 1 else 12) * slots)
            self._table = np.zeros(slots, np.int64)
            if len(self._store) > 1:
                self._numbers = np.zeros(slots, np.int32)
            self._fill()

    def _fill(self) -> None:
        """Enters all states, which are distinct, into an empty table."""
        for first in range(0, self.count, _FILLED_AT_ONCE):
            last = min(first + _FILLED_AT_ONCE, self.count)
            keys = _keys(self.states(first, last))
            slots = self._slots(keys)
            numbers = np.arange(first, last)
            while len(slots):
                free = np.flatnonzero(self._table.take(slots) == 0)
                self._table[slots[free]] = ~numbers[free]
                won = free[self._table.take(slots[free]) == ~numbers[free]]
                self._table[slots[won]] = keys[won]
                if len(self._store) > 1:
                    self._numbers[slots[won]] = numbers[won]
                lost = np.ones(len(slots), np.bool_)
                lost[won] = False
                slots, keys, numbers = slots[lost] + 1, keys[lost], numbers[lost]
                slots &= len(self._table) - 1

    def _number(self) -> None:
        """Makes the numbers of the slots."""
        self._limits.check(self.bytes + 4 * len(self._table))
        self._numbers = np.zeros(len(self._table), np.int32)
        for first in range(0, self.count, _FILLED_AT_ONCE):
            last = min(first + _FILLED_AT_ONCE, self.count)
            states = self.states(first, last)
            self._numbers[self._places(_keys(states), states)] = np.arange(first, last)
        self._numbered = self.count


def _keys(batch: Words) -> Keys:
    """The key of each state, a positive number."""
    if len(batch) == 1:
        return batch[0] + 1
    mixed = np.zeros(len(batch[0]), np.uint64)
    for at, word in enumerate(batch):
        mixed ^= word.view(np.uint64) * np.uint64(_MULTIPLIERS[at % len(_MULTIPLIERS)])
        mixed ^= mixed >> np.uint64(29)
        mixed *= np.uint64(_MULTIPLIERS[(at + 1) % len(_MULTIPLIERS)])
    mixed >>= np.uint64(1)
    mixed |= np.uint64(1)
    return mixed.view(np.int64)


def _longer(word: npt.NDArray[np.int64], size: int) -> npt.NDArray[np.int64]:
    result = np.zeros(size, np.int64)
    result[: len(word)] = word
    return result
